// SPDX-License-Identifier: MIT
// Gravity and the joint error maps as a user meets them: found where they help, stored, and
// applied by every command.
#include <nlohmann/json.hpp>

#include "host_tests/cli/refined_arm.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

Csv many_poses(const Folder& folder) {
  write_file(folder / "arm.yaml", kPuma560);
  const Outcome outcome = run_tool(
      folder,
      "simulate --arm arm.yaml --tolerances 1 --flange-target-mm 80,30,120 --sigma-mm 0.02 "
      "--free-poses 400 --seed 12 --out good.csv --truth-out truth.yaml");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  Csv rows = Csv::read(folder / "good.csv");
  keep_mixed(rows);
  return rows;
}

TEST(RefinedDeflections, are_found_where_they_help_stored_and_applied) {
  const Folder folder;
  const Csv good = many_poses(folder);
  const Csv rows = with_wavy_readings(good);
  const Outcome outcome = refine(folder, rows, "--json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json result = json::parse(outcome.out);
  const double left_out = result["cross_validation"]["mean_m"];
  EXPECT_LT(left_out, 0.4 * result["refinement"]["geometry_left_out_mean_m"].get<double>());
  EXPECT_LT(left_out, 0.2e-3);
  write_joint_poses(good, folder / "q.csv");
  const Csv truth = predict(folder, "truth.yaml", "1");
  write_joint_poses(rows, folder / "q.csv");
  const Csv predicted = predict(folder, "s.yaml", "1");
  EXPECT_LT(largest_distance(predicted, truth), 0.4e-3);
  // The inverse goes through the map and back.
  const Outcome solved = run_tool(
      folder, "solve --signature s.yaml --poses p.csv --seed q.csv --target 1 --out solved.csv");
  ASSERT_EQ(solved.status, 0) << solved.err;
  std::filesystem::rename(folder / "solved.csv", folder / "q.csv");
  EXPECT_LT(largest_distance(predict(folder, "s.yaml", "1"), predicted), 1e-9);
  measured_again(Csv::read(folder / "m.csv")).write(folder / "later.csv");
  EXPECT_EQ(run_tool(folder, "check --signature s.yaml --measurements later.csv").status, 0);
  const Outcome exported =
      run_tool(folder, "export --signature s.yaml --format urdf --out arm.urdf");
  EXPECT_EQ(exported.status, 0);
  EXPECT_NE(exported.err.find("mm RMS at the tool are lost"), std::string::npos) << exported.err;
}

TEST(RefinedDeflections, stand_in_the_list_of_models_that_were_tried) {
  const Folder folder;
  const Outcome outcome = refine(folder, with_wavy_readings(many_poses(folder)), "--json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json result = json::parse(outcome.out);
  const json& tried = result["refinement"]["models_tried"];
  ASSERT_GE(tried.size(), 3U);
  EXPECT_EQ(tried[0]["model"], "geometry");
  EXPECT_EQ(tried[0]["left_out_mean_m"], result["refinement"]["geometry_left_out_mean_m"]);
  std::size_t written = 0;
  for (const json& model : tried) {
    if (!model["written"].get<bool>()) continue;
    ++written;
    EXPECT_NE(model["model"].get<std::string>().find("joint error maps"), std::string::npos);
    EXPECT_EQ(model["left_out_mean_m"], result["cross_validation"]["mean_m"]);
    EXPECT_EQ(model["rows_rejected"], result["refinement"]["rows_rejected"]);
  }
  EXPECT_EQ(written, 1U);
  const Outcome explained = run_tool(folder,
                                     "identify --arm arm.yaml --measurements m.csv --method "
                                     "refined --out s.yaml --explain");
  EXPECT_NE(explained.out.find("Models tried"), std::string::npos) << explained.out;
  EXPECT_NE(explained.out.find("geometry, gravity, joint error maps"), std::string::npos);
  EXPECT_NE(explained.out.find(" written\n"), std::string::npos) << explained.out;
}

TEST(RefinedDeflections, are_left_out_where_there_are_none) {
  const Folder folder;
  const Outcome outcome = refine(folder, many_poses(folder), "--json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_FALSE(json::parse(outcome.out).contains("geometry_left_out_mean_m"));
  EXPECT_FALSE(json::parse(outcome.out)["refinement"].contains("geometry_left_out_mean_m"));
  EXPECT_EQ(read_file(folder / "s.yaml").find("deflections:"), std::string::npos);
}

// What sweeps leave open at poses that they do not reach is said.
TEST(RefinedDeflections, of_sweeps_are_no_promise_for_the_poses_between_them) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  double observed_squares = 0;
  double stated_squares = 0;
  for (const int seed : {1, 2, 3, 4}) {
    const Outcome simulated = run_tool(
        folder,
        "simulate --arm arm.yaml --tolerances 1 --deflection-mm 1 --sigma-mm 0.1 --points 24 "
        "--flange-target-mm 100,40,120 --free-poses 60 --out all.csv --truth-out "
        "truth.yaml --seed " +
            std::to_string(seed));
    ASSERT_EQ(simulated.status, 0) << simulated.err;
    const Csv all = Csv::read(folder / "all.csv");
    Csv sweeps = all;
    std::erase_if(sweeps.rows, [&](const Fields& row) { return row[all.column("sweep")] == "0"; });
    const Outcome outcome = refine(folder, sweeps, "--json");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const double stated_m = json::parse(outcome.out)["predicted_over_limits_m"];
    write_joint_poses(all, folder / "q.csv");
    const double observed_m =
        rms_distance(predict(folder, "s.yaml", "1"), predict(folder, "truth.yaml", "1"));
    observed_squares += observed_m * observed_m;
    stated_squares += stated_m * stated_m;
  }
  const double ratio = std::sqrt(observed_squares / stated_squares);
  EXPECT_GT(ratio, 0.6);
  EXPECT_LT(ratio, 1.4);
}

TEST(RefinedDeflections, a_damaged_map_is_refused) {
  const Folder folder;
  ASSERT_EQ(refine(folder, with_wavy_readings(many_poses(folder))).status, 0);
  std::string text = read_file(folder / "s.yaml");
  const std::size_t values = text.find("values: [");
  ASSERT_NE(values, std::string::npos);
  text.insert(values + 9, "9");
  write_file(folder / "s.yaml", text);
  const Outcome outcome = run_tool(folder, "predict --signature s.yaml --joints q.csv --out p.csv");
  EXPECT_EQ(outcome.status, 2);
}

}  // namespace
}  // namespace armsig::cli
