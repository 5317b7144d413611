// SPDX-License-Identifier: MIT
// Readings that are not what they seem, with `identify --method refined`: coupled, reversed, with
// gain.
#include <nlohmann/json.hpp>

#include "host_tests/cli/refined_arm.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

constexpr double kOffCentre_deg = 0.02;

std::string with_coupled_elbow(double ratio) {
  return std::string(kPuma560) +
         "coupling:\n  - {joint: 3, from: 2, ratio: " + std::to_string(ratio) + "}\n";
}

TEST(Refined, follows_a_coupled_elbow_and_says_which_sweep_is_no_circle) {
  const Folder folder;
  const Csv rows = simulated(folder, "--sigma-mm 0", with_coupled_elbow(-1));
  const Outcome outcome = refine(folder, rows);
  expect_said(outcome, "sweep 2 carries joint 3 along");
  EXPECT_LT(error_m(folder), 1e-7);
}

TEST(Refined, solves_for_the_readings_of_a_coupled_elbow) {
  const Folder folder;
  const Csv rows = simulated(folder, "--sigma-mm 0", with_coupled_elbow(-1));
  ASSERT_EQ(refine(folder, rows).status, 0);
  write_joint_poses(rows, folder / "q.csv");
  const Csv asked = predict(folder, "s.yaml", "1");
  // From nearby readings to the same ones; without them to others inside the limits.
  for (const char* seed : {"--seed q.csv", ""}) {
    const Outcome solved =
        run_tool(folder, std::string("solve --signature s.yaml --poses p.csv --target 1 --out "
                                     "solved.csv ") +
                             seed);
    ASSERT_EQ(solved.status, 0) << solved.err;
    std::filesystem::rename(folder / "solved.csv", folder / "q.csv");
    EXPECT_LT(largest_distance(predict(folder, "s.yaml", "1"), asked), 1e-8) << seed;
    const Csv found = Csv::read(folder / "q.csv");
    for (std::size_t k = 0; k < found.rows.size(); ++k) {
      EXPECT_LE(found.number(k, "q3_deg"), 225 + 1e-6);
      EXPECT_GE(found.number(k, "q3_deg"), -45 - 1e-6);
    }
  }
}

TEST(Refined, sweeps_of_a_coupled_elbow_are_refused_by_the_features) {
  const Folder folder;
  simulated(folder, "--sigma-mm 0", with_coupled_elbow(-1)).write(folder / "m.csv");
  const Outcome outcome = run_tool(
      folder, "identify --arm arm.yaml --measurements m.csv --method encoder --out s.yaml");
  expect_refused(folder, outcome, 1, "sweep 2 carries joint 3 along");
  EXPECT_NE(outcome.err.find("--method refined"), std::string::npos) << outcome.err;
}

TEST(Refined, names_a_coupling_that_the_arm_description_lacks) {
  for (const bool with_sweeps : {false, true}) {
    const Folder folder;
    Csv rows = simulated(folder, "--sigma-mm 0.1", with_coupled_elbow(-1));
    write_file(folder / "arm.yaml", kPuma560);
    if (!with_sweeps) keep_mixed(rows);
    const Outcome outcome = refine(folder, rows);
    expect_refused(folder, outcome, 1, "joint 3 seems to follow joint 2");
    EXPECT_NE(outcome.err.find("coupling: [{joint: 3, from: 2"), std::string::npos) << outcome.err;
  }
}

TEST(Refined, names_a_joint_whose_reading_has_the_wrong_sign) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.1");
  keep_mixed(rows);
  for (Fields& row : rows.rows) {
    std::string& q = row[rows.column("q4_deg")];
    q = q.starts_with('-') ? q.substr(1) : "-" + q;
  }
  expect_refused(folder, refine(folder, rows), 1, "joint 4 seems to turn against");
}

// The readings of joint 2 as an encoder gives them that counts 0.3 % too little.
void shrink_reading(Csv& rows) {
  for (Fields& row : rows.rows) {
    char text[40];
    std::string& q = row[rows.column("q2_deg")];
    std::snprintf(text, sizeof text, "%.17g", std::stod(q) / 1.003);
    q = text;
  }
}

TEST(Refined, finds_stores_and_applies_corrections_of_the_readings) {
  const Folder folder;
  const Csv good = simulated(folder, "--sigma-mm 0");
  write_joint_poses(good, folder / "q.csv");
  const Csv truth = predict(folder, "truth.yaml", "1");
  Csv rows = good;
  keep_mixed(rows);
  shrink_reading(rows);
  const Outcome outcome = refine(folder, rows, "--correct gain,second-order --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json corrections = json::parse(outcome.out)["refinement"]["reading_corrections"];
  EXPECT_NEAR(corrections[1]["gain"], 0.003, 1e-6);
  EXPECT_NE(read_file(folder / "s.yaml").find("reading_correction: {gain: "), std::string::npos);
  // Predictions are asked for in the encoder's readings, and come out true; so do solutions.
  write_joint_poses(rows, folder / "q.csv");
  EXPECT_LT(largest_distance(predict(folder, "s.yaml", "1"), truth), 1e-6);
  measured_again(Csv::read(folder / "m.csv")).write(folder / "later.csv");
  EXPECT_EQ(run_tool(folder, "check --signature s.yaml --measurements later.csv").status, 0);
  EXPECT_EQ(
      run_tool(folder, "suggest --signature s.yaml --count 2 --sigma-mm 0.2 --out n.csv").status,
      0);
  const Outcome exported =
      run_tool(folder, "export --signature s.yaml --format urdf --out arm.urdf");
  EXPECT_EQ(exported.status, 1);
  EXPECT_NE(exported.err.find("its joint readings are corrected"), std::string::npos);
  Csv first = Csv::read(folder / "q.csv");
  first.rows.resize(1);
  first.write(folder / "q.csv");
  predict(folder, "s.yaml", "1");
  const Outcome solved = run_tool(
      folder, "solve --signature s.yaml --poses p.csv --seed q.csv --target 1 --out back.csv");
  ASSERT_EQ(solved.status, 0) << solved.err;
  EXPECT_NEAR(Csv::read(folder / "back.csv").number(0, "q2_deg"), first.number(0, "q2_deg"), 1e-6);
}

TEST(Refined, chooses_the_corrections_that_help) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.05");
  keep_mixed(rows);
  const Outcome plain = refine(folder, rows, "--correct readings-that-help --json");
  ASSERT_EQ(plain.status, 0) << plain.err;
  EXPECT_FALSE(json::parse(plain.out)["refinement"].contains("reading_corrections"));
  EXPECT_FALSE(json::parse(plain.out)["refinement"].contains("corrections_offered"));
  shrink_reading(rows);
  const Outcome corrected = refine(folder, rows, "--correct readings-that-help --json");
  ASSERT_EQ(corrected.status, 0) << corrected.err;
  EXPECT_TRUE(json::parse(corrected.out)["refinement"].contains("reading_corrections"));
}

// In sweeps of ninety degrees a map takes up what the gear does, and poses beyond them look like
// blunders.
TEST(Refined, finds_a_gear_that_is_off_unasked_and_names_it) {
  const Folder folder;
  const Csv good = simulated(folder, "--sigma-mm 0.05");
  write_joint_poses(good, folder / "q.csv");
  const Csv truth = predict(folder, "truth.yaml", "1");
  Csv rows = good;
  shrink_reading(rows);
  const Outcome outcome = refine(folder, rows, "--json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("joint 2: its reading is 0.997"), std::string::npos) << outcome.err;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["refinement"]["rows_rejected"], 0);
  write_joint_poses(rows, folder / "q.csv");
  const double observed = rms_distance(predict(folder, "s.yaml", "1"), truth);
  EXPECT_LT(observed, 1.5 * result["predicted_tool_error_m"].get<double>());
  EXPECT_LT(observed, 1e-4);
}

TEST(Refined, finds_no_gear_where_none_is_wanted) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.05");
  shrink_reading(rows);
  refine(folder, rows);
  const std::string exporting = "export --signature s.yaml --format rtb --out arm.py";
  const Outcome refused = run_tool(folder, exporting);
  EXPECT_EQ(refused.status, 1);
  EXPECT_NE(refused.err.find("--correct none"), std::string::npos) << refused.err;
  keep_mixed(rows);
  const Outcome outcome = refine(folder, rows, "--correct none --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_FALSE(json::parse(outcome.out)["refinement"].contains("reading_corrections"));
  EXPECT_EQ(run_tool(folder, exporting).status, 0);
  std::filesystem::remove(folder / "s.yaml");
  expect_refused(folder, refine(folder, rows, "--correct none,gain"), 2, "either of them");
}

// An encoder disc that is a little off its centre: it helps, but nothing is wrong without it.
TEST(Refined, offers_corrections_that_would_help_a_little) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.05");
  keep_mixed(rows);
  for (Fields& row : rows.rows) {
    std::string& text = row[rows.column("q2_deg")];
    const double q = std::stod(text);
    char eccentric[40];
    std::snprintf(eccentric, sizeof eccentric, "%.17g",
                  q - kOffCentre_deg * std::sin(q * 0.017453292519943295));
    text = eccentric;
  }
  expect_said(refine(folder, rows), "with corrections of the joint readings");
}

TEST(Refined, refuses_a_scale_from_angles_alone) {
  const Folder folder;
  const Csv rows = simulated(folder, "--sigma-mm 0.1");
  expect_refused(folder, refine(folder, rows, "--correct scale"), 1, "angles alone");
}

// Free poses in which the motor of the last joint rests.
Csv with_resting_last_motor(const Folder& folder, const std::string& arm = kPuma560) {
  Csv rows = simulated(folder, "--sigma-mm 0.1", arm);
  keep_mixed(rows);
  for (Fields& row : rows.rows) row[rows.column("q6_deg")] = "10";
  // The target is where a resting last joint had it.
  Csv joints = rows;
  write_joint_poses(joints, folder / "q.csv");
  const Csv truth = predict(folder, "truth.yaml", "1");
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    for (const char* axis : {"x", "y", "z"}) {
      rows.rows[k][rows.column(std::string(axis) + "_mm")] =
          std::to_string(1e3 * truth.number(k, std::string(axis) + "_m"));
    }
  }
  return rows;
}

TEST(Refined, holds_a_correction_that_the_rows_do_not_tell_and_names_the_joint) {
  const Folder folder;
  expect_said(refine(folder, with_resting_last_motor(folder), "--correct gain"),
              "joint 6 stood still: nothing measured tells its parameters");
}

TEST(Refined, a_joint_that_another_turns_did_not_stand_still) {
  const Folder folder;
  const std::string coupled =
      std::string(kPuma560) + "\ncoupling: [{joint: 6, from: 5, ratio: 0.3}]\n";
  const Outcome outcome = refine(folder, with_resting_last_motor(folder, coupled));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("stood still"), std::string::npos) << outcome.err;
}

TEST(Refined, refuses_corrections_by_another_method_or_of_what_is_not_there) {
  const Folder folder;
  simulated(folder).write(folder / "m.csv");
  const std::string identify = "identify --arm arm.yaml --measurements m.csv --out s.yaml ";
  expect_refused(folder, run_tool(folder, identify + "--method encoder --correct gain"), 2,
                 "--method refined");
  expect_refused(folder, run_tool(folder, identify + "--method refined --correct range-offsets"), 2,
                 "receivers");
  EXPECT_NE(run_tool(folder, identify + "--method refined --correct gian").status, 0);
}

}  // namespace
}  // namespace armsig::cli
