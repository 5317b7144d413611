// SPDX-License-Identifier: MIT
// Sets on which the model that is written and the judges of it once disagreed, in
// ../shared/data/cases, each with its true value; and the same kinds made here, so that something
// is tried where the folder is absent.
#include <algorithm>
#include <cmath>
#include <random>

#include <nlohmann/json.hpp>

#include "host_tests/cli/nominal_arm.hpp"
#include "host_tests/cli/refined_arm.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

const std::filesystem::path kCases = kShared / "cases";

#define SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << (path)

Outcome identify(const Folder& folder, const std::string& arm,
                 const std::filesystem::path& measurements, const std::string& options = "") {
  return run_tool(folder, "identify --arm '" + arm + "' --measurements '" + measurements.string() +
                              "' --method refined --out s.yaml " + options);
}

json checked(const Folder& folder, const std::filesystem::path& measurements) {
  const Outcome outcome = run_tool(
      folder, "check --signature s.yaml --json --measurements '" + measurements.string() + "'");
  EXPECT_NE(outcome.status, 2) << outcome.err;
  return json::parse(outcome.out, nullptr, false);
}

std::string since_then(const json& result) {
  std::string words;
  for (const auto& one : result.value("since_then", json::array())) {
    words += one.get<std::string>() + "; ";
  }
  return words;
}

void expect_words(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
}

void expect_no_words(const std::string& text, const std::string& words) {
  EXPECT_EQ(text.find(words), std::string::npos) << words << "\n" << text;
}

// The number that follows `words`.
double number_after(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  EXPECT_NE(at, std::string::npos) << words << "\n" << text;
  return at == std::string::npos ? std::nan("") : std::stod(text.substr(at + words.size()));
}

TEST(ModelCases, a_joint_that_stood_still_is_accused_of_nothing) {
  SKIP_WITHOUT(kCases / "sag/sag.csv");
  const Folder folder;
  const Outcome outcome = identify(folder, "iiwa7", kCases / "sag/sag.csv");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  expect_no_words(outcome.err, "coupl");
  expect_no_words(outcome.err, "backlash");
  expect_no_words(outcome.err, "times what it moves");
  expect_no_words(outcome.err, "not determined");
  expect_words(outcome.err, "joints 3 to 7 stood still: nothing measured tells their parameters, ");
  const double mean_m = checked(folder, kCases / "sag/sag_test.csv")["mean_m"].get<double>();
  // Even of the base and target that fit these very poses best.
  EXPECT_LT(mean_m, nominal_mean_m("iiwa7", Csv::read(kCases / "sag/sag_test.csv")));
  EXPECT_LT(mean_m, 1.2e-3);
}

TEST(ModelCases, a_soft_joint_keeps_its_gravity) {
  SKIP_WITHOUT(kCases / "sag/soft.csv");
  const Folder folder;
  ASSERT_EQ(identify(folder, "irb120", kCases / "sag/soft.csv").status, 0);
  EXPECT_LT(checked(folder, kCases / "sag/soft_test.csv")["mean_m"].get<double>(), 0.035e-3);
}

TEST(ModelCases, a_small_coupling_is_named_and_no_blunder) {
  SKIP_WITHOUT(kCases / "coupling/m.csv");
  const Folder folder;
  const std::filesystem::path rows = kCases / "coupling/m.csv";
  const Outcome outcome = identify(folder, (kCases / "coupling/puma.yaml").string(), rows);
  EXPECT_EQ(outcome.status, 1) << outcome.out;
  expect_words(outcome.err, "of the 60 free poses");
  EXPECT_NEAR(number_after(outcome.err, "joint 5 follows joint 4 by "), 0.005, 1e-4);
  EXPECT_NEAR(number_after(outcome.err, "coupling: [{joint: 5, from: 4, ratio: "), 0.005, 1e-4);
  const Outcome as_built =
      identify(folder, (kCases / "coupling/puma-as-built.yaml").string(), rows, "--json");
  ASSERT_EQ(as_built.status, 0) << as_built.err;
  const json result = json::parse(as_built.out);
  EXPECT_EQ(result["refinement"]["rows_rejected"], 0);
  EXPECT_LT(result["cross_validation"]["mean_m"].get<double>(), 0.1e-3);
}

TEST(ModelCases, more_rows_do_not_make_it_worse) {
  SKIP_WITHOUT(kShared / "ur10-laser-tracker/many-poses.csv");
  const Folder folder;
  const Outcome outcome =
      identify(folder, "ur10", kShared / "ur10-laser-tracker/many-poses.csv", "--json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_LT(json::parse(outcome.out)["cross_validation"]["mean_m"].get<double>(), 0.08e-3);
}

TEST(ModelCases, backlash_is_found_by_the_order_of_the_rows) {
  SKIP_WITHOUT(kCases / "play/both-ways.csv");
  const Folder folder;
  const Outcome outcome = identify(folder, (kCases / "play/arm.yaml").string(),
                                   kCases / "play/both-ways.csv", "--json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* joint : {"joint 1: ", "joint 2: ", "joint 3: "}) {
    EXPECT_NEAR(number_after(outcome.err, joint), 0.06, 0.002);
  }
  expect_words(outcome.err, "of backlash, by the order of the rows");
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["refinement"]["rows_rejected"], 0);
  EXPECT_LT(result["cross_validation"]["mean_m"].get<double>(), 0.1e-3);
}

TEST(ModelCases, leads_of_slides_are_not_the_axes_of_the_sensor) {
  SKIP_WITHOUT(kCases / "slides/gantry.yaml");
  const Folder folder;
  for (const char* rows : {"slides/gantry-500ppm.csv", "slides/gantry-1000ppm.csv"}) {
    const Outcome outcome =
        identify(folder, (kCases / "slides/gantry.yaml").string(), kCases / rows, "--json");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    expect_no_words(outcome.err, "the sensor's axes");
    EXPECT_LT(json::parse(outcome.out)["predicted_tool_error_m"].get<double>(), 0.6e-3);
  }
}

TEST(ModelCases, check_names_what_has_happened_and_not_the_sensor) {
  SKIP_WITHOUT(kCases / "check/before.csv");
  const Folder folder;
  ASSERT_EQ(
      identify(folder, (kCases / "check/iiwa7.yaml").string(), kCases / "check/before.csv").status,
      0);
  EXPECT_EQ(checked(folder, kCases / "check/healthy.csv")["verdict"], "consistent");
  const json crash = checked(folder, kCases / "check/crash-3-zeros.csv");
  EXPECT_EQ(crash["verdict"], "drifted");
  for (const char* zero :
       {"joint 2 has moved by -0.", "joint 5 has moved by +2.0", "joint 6 has moved by +0.5"}) {
    expect_words(since_then(crash), zero);
  }
  const json entered = checked(folder, kCases / "check/offsets-now-in-the-controller.csv");
  EXPECT_EQ(entered["verdict"], "drifted");
  expect_words(since_then(entered), "the zero of joint");
}

TEST(ModelCases, check_tells_place_and_target_apart_and_together) {
  SKIP_WITHOUT(kCases / "moved/train.csv");
  const Folder folder;
  ASSERT_EQ(identify(folder, "ur5", kCases / "moved/train.csv").status, 0);
  const json reseated = checked(folder, kCases / "moved/reseated.csv");
  EXPECT_NEAR(number_after(since_then(reseated), "target 1 is another point, "), 0.894, 0.02);
  expect_no_words(since_then(reseated), "elsewhere");
  const json both = checked(folder, kCases / "moved/moved-and-reseated.csv");
  EXPECT_NEAR(number_after(since_then(both), "target 1 is another point, "), 0.894, 0.02);
  expect_words(since_then(both), "stands elsewhere: 4");
  EXPECT_LT(both["rms_with_that_m"].get<double>(), 0.06e-3);
}

// Readings of an arm whose joints stay behind their motors by half of `play_deg`, on the side that
// each came from.
Csv with_play(Csv rows, double play_deg) {
  for (const char* joint : {"q1_deg", "q2_deg", "q3_deg"}) {
    const std::size_t column = rows.column(joint);
    double before = 0;
    double side = 0;
    for (std::size_t k = 0; k < rows.rows.size(); ++k) {
      std::string& text = rows.rows[k][column];
      const double q = std::stod(text);
      if (k > 0 && std::abs(q - before) > 0.02) side = q > before ? 1 : -1;
      before = q;
      char read[40];
      std::snprintf(read, sizeof read, "%.17g", q + side * play_deg / 2);
      text = read;
    }
  }
  return rows;
}

// Sweeps and free poses of a Puma.
Csv measured_puma(const Folder& folder, const std::string& arm, const std::string& options) {
  write_file(folder / "arm.yaml", arm);
  const Outcome outcome =
      run_tool(folder,
               "simulate --arm arm.yaml --tolerances 1 --flange-target-mm 80,30,120 --arc 90 "
               "--points 20 --seed 11 --out good.csv " +
                   options);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return Csv::read(folder / "good.csv");
}

TEST(ModelCases, play_of_a_simulated_arm_is_found_and_stated) {
  const Folder folder;
  Csv rows = measured_puma(folder, kPuma560, "--free-poses 160 --sigma-mm 0.02");
  keep_mixed(rows);
  const Outcome outcome = refine(folder, with_play(rows, 0.06), "--json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* joint : {"joint 1: ", "joint 2: ", "joint 3: "}) {
    EXPECT_NEAR(number_after(outcome.err, joint), 0.06, 0.002);
  }
  expect_no_words(outcome.err, "joint 5: 0.");
  const json result = json::parse(outcome.out);
  EXPECT_LT(result["cross_validation"]["mean_m"].get<double>(), 0.06e-3);
  // Half of 0.06 degrees of three joints, at levers of half a metre or so.
  EXPECT_GT(result["predicted_tool_error_m"].get<double>(), 0.15e-3);
}

// Pairs of joints, which many more rows would tell, do not count against it.
TEST(ModelCases, play_is_found_from_few_poses) {
  const Folder folder;
  Csv rows = measured_puma(folder, kPuma560, "--free-poses 70 --sigma-mm 0.02");
  keep_mixed(rows);
  const Outcome outcome = refine(folder, with_play(rows, 0.06), "--json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NEAR(number_after(outcome.err, "joint 2: "), 0.06, 0.004);
  const json result = json::parse(outcome.out);
  EXPECT_LT(result["cross_validation"]["mean_m"].get<double>(), 0.1e-3);
}

TEST(ModelCases, an_arm_without_play_has_none) {
  const Folder folder;
  Csv rows = measured_puma(folder, kPuma560, "--free-poses 160 --sigma-mm 0.02");
  keep_mixed(rows);
  const Outcome outcome = refine(folder, rows);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  expect_no_words(outcome.err, "backlash");
}

// The target's place on the flange and the axis of the flange are then those of the drawing, by
// chance, wherever the flange is turned.
TEST(ModelCases, a_flange_that_never_turned_is_stated_for_all_its_readings) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.0001");
  keep_mixed(rows);
  const std::size_t flange = rows.column("q6_deg");
  for (Fields& row : rows.rows) row[flange] = "20";
  write_joint_poses(rows, folder / "q.csv");
  const Csv at = predict(folder, "truth.yaml", "1");
  std::mt19937 random(3);
  std::normal_distribution<double> noise_mm(0, 0.03);
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    for (const std::string axis : {"x", "y", "z"}) {
      const double p_mm = 1e3 * at.number(k, axis + "_m") + noise_mm(random);
      rows.rows[k][rows.column(axis + "_mm")] = std::to_string(p_mm);
    }
  }
  const Outcome outcome = refine(folder, rows, "--json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("joint 6 stood still"), std::string::npos) << outcome.err;
  const double stated_m = json::parse(outcome.out)["predicted_tool_error_m"].get<double>();
  write_joint_poses(Csv::read(folder / "good.csv"), folder / "q.csv");
  const Csv found = predict(folder, "s.yaml", "1");
  const double missed_m = std::sqrt(3.0) * rms_distance(found, predict(folder, "truth.yaml", "1"));
  EXPECT_LT(missed_m, 1.5 * stated_m);
  EXPECT_GT(missed_m, 0.2 * stated_m);
}

TEST(ModelCases, a_coupling_of_a_simulated_arm_is_named) {
  const Folder folder;
  std::string coupled = kPuma560;
  coupled += "coupling:\n  - {joint: 3, from: 2, ratio: 0.01}\n";
  const Csv rows = measured_puma(folder, coupled, "--free-poses 60 --sigma-mm 0.05");
  write_file(folder / "arm.yaml", kPuma560);
  const Outcome outcome = refine(folder, rows);
  EXPECT_EQ(outcome.status, 1) << outcome.out;
  expect_words(outcome.err, "joint 3 follows joint 2 by +0.0");
  write_file(folder / "arm.yaml", coupled);
  EXPECT_EQ(refine(folder, rows).status, 0);
}

}  // namespace
}  // namespace armsig::cli
