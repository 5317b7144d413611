// SPDX-License-Identifier: MIT
// The paper's task on an arm whose readings err and that gravity bends: signature and truth turn by
// what they know, the drawing knows of neither.
#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "host_tests/cli/refined_arm.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

// As drawn but for its readings and gravity.
void refine_a_bent_arm(const Folder& folder) {
  write_file(folder / "arm.yaml", kPuma560);
  const Outcome outcome = run_tool(
      folder,
      "simulate --arm arm.yaml --flange-target-mm 80,30,120 --sigma-mm 0.02 --maps-deg 0.05 "
      "--deflection-mm 2 --free-poses 300 --seed 5 --out good.csv --truth-out truth.yaml");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  Csv rows = Csv::read(folder / "good.csv");
  keep_mixed(rows);
  const Outcome refined = refine(folder, rows);
  ASSERT_EQ(refined.status, 0) << refined.err;
}

json evaluation(const Folder& folder, const std::string& truth) {
  const Outcome outcome =
      run_tool(folder, "evaluate --arm arm.yaml --signature s.yaml --json --truth " + truth);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return json::parse(outcome.out)["evaluation"];
}

double radial_m(const json& of_model) { return of_model["radial_deviation_m"]; }

TEST(Evaluate, touches_with_the_maps_and_the_gravity_of_the_arm_and_of_the_signature) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(refine_a_bent_arm(folder));
  const json bent = evaluation(folder, "truth.yaml");
  EXPECT_GT(radial_m(bent["ideal"]), 0.2e-3);
  EXPECT_LT(radial_m(bent["with_signature"]), 0.3 * radial_m(bent["ideal"]));
  // An arm that reads as it turns is not the one of this signature.
  const json straight = evaluation(folder, "arm.yaml");
  EXPECT_GT(radial_m(straight["with_signature"]), 3 * radial_m(bent["with_signature"]));
}

TEST(Evaluate, refuses_the_drawing_and_the_truth_of_another_arm) {
  const Folder folder;
  ASSERT_EQ(run_tool(folder,
                     "simulate --arm puma560 --tolerances 1 --flange-target-mm 80,30,120 --seed 2 "
                     "--out m.csv --truth-out truth.yaml")
                .status,
            0);
  ASSERT_EQ(run_tool(folder, "identify --arm puma560 --measurements m.csv --out s.yaml").status, 0);
  const auto evaluate = [&](const std::string& arm, const std::string& truth) {
    return run_tool(folder, "evaluate --signature s.yaml --arm " + arm + " --truth " + truth);
  };
  const Outcome same = evaluate("puma560", "truth.yaml");
  EXPECT_EQ(same.status, 0);
  EXPECT_EQ(same.err, "");
  // Another drawing, and near enough.
  std::string near = kPuma560;
  near.replace(near.find("430.7"), 5, "431.7");
  write_file(folder / "near.yaml", near);
  const Outcome beside = evaluate("near.yaml", "truth.yaml");
  EXPECT_EQ(beside.status, 0) << beside.err;
  EXPECT_EQ(beside.err,
            "armsig: warning: s.yaml: found with another nominal model than that of near.yaml\n");
  // As drawn, but for the forearm.
  std::string longer = kPuma560;
  longer.replace(longer.find("430.7"), 5, "470.7");
  write_file(folder / "longer.yaml", longer);
  for (const std::string arm : {"ur10e", "longer.yaml"}) {
    const Outcome other = evaluate(arm, "truth.yaml");
    EXPECT_EQ(other.status, 1) << arm;
    EXPECT_NE(other.err.find("s.yaml: it is not of the arm of " + arm), std::string::npos)
        << other.err;
    EXPECT_NE(other.err.find("--arm with the nominal model of the signature"), std::string::npos);
  }
  const Outcome false_truth = evaluate("puma560", "longer.yaml");
  EXPECT_EQ(false_truth.status, 1);
  EXPECT_NE(false_truth.err.find("longer.yaml: it is not of the arm of puma560"), std::string::npos)
      << false_truth.err;
}

TEST(Report, refuses_measurements_and_a_truth_that_are_not_of_its_arm) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  const std::string simulate = "simulate --flange-target-mm 80,30,120 --seed 2 ";
  ASSERT_EQ(run_tool(folder, simulate + "--arm arm.yaml --tolerances 1 --out m.csv "
                                        "--truth-out truth.yaml")
                .status,
            0);
  ASSERT_EQ(run_tool(folder, simulate + "--arm ur5 --out u.csv --truth-out u.yaml").status, 0);
  ASSERT_EQ(run_tool(folder, "identify --arm arm.yaml --measurements m.csv --out s.yaml").status,
            0);
  Csv rows = Csv::read(folder / "m.csv");
  for (std::string& name : rows.header) {
    if (name.ends_with("_mm")) name.replace(name.size() - 2, 2, "m");
  }
  rows.write(folder / "metres.csv");
  const auto report = [&](const std::string& with) {
    return run_tool(folder, "report --signature s.yaml --out r.html " + with);
  };
  EXPECT_EQ(report("--measurements m.csv --truth truth.yaml").status, 0);
  for (const std::string file : {"u.csv", "metres.csv"}) {
    const Outcome other = report("--measurements " + file);
    EXPECT_EQ(other.status, 1) << file;
    EXPECT_NE(other.err.find(file + ": the signature misses half of the rows by"),
              std::string::npos)
        << other.err;
  }
  const Outcome other = report("--truth u.yaml");
  EXPECT_EQ(other.status, 1);
  EXPECT_NE(other.err.find("u.yaml: it is not of the arm of the signature's nominal model"),
            std::string::npos)
      << other.err;
}

TEST(Report, compares_with_an_arm_that_bends_where_its_tool_really_is) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(refine_a_bent_arm(folder));
  const Outcome outcome =
      run_tool(folder, "report --signature s.yaml --truth truth.yaml --out r.html");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string page = read_file(folder / "r.html");
  const auto number = [&](const std::string& key) {
    const std::size_t at = page.find("\"" + key + "\":");
    return at == std::string::npos ? -1 : std::stod(page.substr(at + key.size() + 3));
  };
  const double predicted_m = number("predicted_rms_m");
  ASSERT_GT(predicted_m, 0);
  EXPECT_GT(number("true_rms_m"), 0.4 * predicted_m);
  EXPECT_LT(number("true_rms_m"), 1.6 * predicted_m);
  EXPECT_GT(number("true_nominal_rms_m"), 0.3e-3);
}

}  // namespace
}  // namespace armsig::cli
