// SPDX-License-Identifier: MIT
// `identify --method refined` of ranges to receivers: the same engine as for positions, with the
// same figures.
#include <algorithm>
#include <cmath>
#include <random>

#include <nlohmann/json.hpp>

#include "host_tests/cli/refined_arm.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

constexpr const char* kSensorDescription =
    "armsig: sensor/1\nname: eight around a square\nreceivers:\n"
    "  - {x_mm: -600, y_mm: -600, z_mm: 2000}\n  - {x_mm: 0, y_mm: -600, z_mm: 2100}\n"
    "  - {x_mm: 600, y_mm: -600, z_mm: 2000}\n  - {x_mm: -600, y_mm: 0, z_mm: 2100}\n"
    "  - {x_mm: 600, y_mm: 0, z_mm: 2100}\n  - {x_mm: -600, y_mm: 600, z_mm: 2000}\n"
    "  - {x_mm: 0, y_mm: 600, z_mm: 2100}\n  - {x_mm: 600, y_mm: 600, z_mm: 2000}\n"
    "path: one-way\nrange_sigma_mm: 0.02\nfacing: [0, 0, -1]\n";
constexpr double kSigma = 0.02e-3;

// Ranges to eight receivers, at mixed poses only.
Csv ranges(const Folder& folder, int poses, const std::string& options = "") {
  write_file(folder / "arm.yaml", kPuma560);
  write_file(folder / "sensor.yaml", kSensorDescription);
  const Outcome outcome = run_tool(
      folder,
      "simulate --arm arm.yaml --sensor sensor.yaml --sigma-mm 0.02 --tolerances 1 "
      "--flange-target-mm 80,30,120 --arc 90 --points 10 --seed 3 --out good.csv --truth-out "
      "truth.yaml --free-poses " +
          std::to_string(poses) + " " + options);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  Csv rows = Csv::read(folder / "good.csv");
  keep_mixed(rows);
  return rows;
}

// As `check` and `report` do: the command line is wrong, not the data.
TEST(RefinedRanges, without_the_sensors_description_are_wrong_usage_by_every_method) {
  const Folder folder;
  ranges(folder, 5);
  for (const std::string method : {"paper", "encoder", "refined"}) {
    const Outcome outcome = run_tool(
        folder, "identify --arm arm.yaml --measurements good.csv --out s.yaml --method " + method);
    EXPECT_EQ(outcome.status, 2) << method;
    EXPECT_EQ(outcome.err,
              "armsig: good.csv:3: the rows are ranges to receivers; expected --sensor with a "
              "description of where the receivers stand\n");
    EXPECT_FALSE(std::filesystem::exists(folder / "s.yaml"));
  }
}

TEST(RefinedRanges, leave_poses_out_and_find_what_the_arm_does_beyond_the_sensors_noise) {
  const Folder folder;
  const Csv good = ranges(folder, 150);
  const Csv rows = with_wavy_readings(good);
  const Outcome outcome = refine(folder, rows, "--sensor sensor.yaml --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["cross_validation"]["rows"], 150 * 8);
  const json& refinement = result["refinement"];
  EXPECT_GT(refinement["noise_and_model_error_m"], kSigma);
  EXPECT_TRUE(refinement["stated_sigma_believed"]);
  EXPECT_LT(result["cross_validation"]["mean_m"],
            0.3 * refinement["geometry_left_out_mean_m"].get<double>());
  // What is stated of the tool is what it is, encoders in error and all.
  write_joint_poses(good, folder / "q.csv");
  const Csv truth = predict(folder, "truth.yaml", "1");
  write_joint_poses(rows, folder / "q.csv");
  const double observed = rms_distance(predict(folder, "s.yaml", "1"), truth);
  const double stated = result["predicted_tool_error_m"];
  EXPECT_GT(observed, 0.5 * stated);
  EXPECT_LT(observed, 1.25 * stated);
}

TEST(RefinedRanges, of_sweeps_are_fitted_with_maps_of_the_readings_too) {
  const Folder folder;
  ranges(folder, 100);
  const Csv good = Csv::read(folder / "good.csv");
  const Csv rows = with_wavy_readings(good);
  const Outcome outcome = refine(folder, rows, "--sensor sensor.yaml --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json result = json::parse(outcome.out);
  EXPECT_LT(result["cross_validation"]["mean_m"],
            0.4 * result["refinement"]["geometry_left_out_mean_m"].get<double>());
  // At poses that were never measured.
  const Outcome elsewhere = run_tool(
      folder,
      "simulate --arm arm.yaml --truth truth.yaml --sigma-mm 0 --flange-target-mm 80,30,120 "
      "--points 2 --arc 30 --free-poses 200 --seed 8 --out fresh.csv");
  ASSERT_EQ(elsewhere.status, 0) << elsewhere.err;
  const Csv fresh = Csv::read(folder / "fresh.csv");
  write_joint_poses(fresh, folder / "q.csv");
  const Csv truth = predict(folder, "truth.yaml", "1");
  write_joint_poses(with_wavy_readings(fresh), folder / "q.csv");
  const double ratio = rms_distance(predict(folder, "s.yaml", "1"), truth) /
                       result["predicted_tool_error_m"].get<double>();
  EXPECT_GT(ratio, 0.75);
  EXPECT_LT(ratio, 1.3);
}

TEST(RefinedRanges, noise_alone_is_no_error_of_the_model) {
  const Folder folder;
  const Outcome outcome = refine(folder, ranges(folder, 100), "--sensor sensor.yaml --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json refinement = json::parse(outcome.out)["refinement"];
  EXPECT_NEAR(refinement["noise_and_model_error_m"].get<double>(), kSigma, 0.15 * kSigma);
  EXPECT_LT(error_m(folder), 10 * kSigma);
}

TEST(RefinedRanges, their_order_changes_nothing) {
  const Folder folder;
  const Csv rows = with_wavy_readings(ranges(folder, 60));
  const auto figures = [&](const Csv& ordered) {
    const Outcome outcome =
        refine(folder, ordered, "--sensor sensor.yaml --correct range-offsets,gain --json");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.status == 0 ? json::parse(outcome.out) : json();
  };
  const json first = figures(rows);
  Csv shuffled = rows;
  std::shuffle(shuffled.rows.begin(), shuffled.rows.end(), std::mt19937_64(5));
  const json second = figures(shuffled);
  ASSERT_TRUE(first.is_object() && second.is_object());
  for (const char* figure : {"mean_m", "rms_m", "largest_m"}) {
    const double a = first["cross_validation"][figure];
    EXPECT_NEAR(second["cross_validation"][figure].get<double>(), a, 1e-6 * a) << figure;
  }
  const double a = first["predicted_tool_error_m"];
  EXPECT_NEAR(second["predicted_tool_error_m"].get<double>(), a, 1e-6 * a);
}

TEST(RefinedRanges, find_the_offset_of_each_receiver) {
  const Folder folder;
  ranges(folder, 1);
  const Csv rows = ranges(folder, 100, "--bias-mm 0.7");
  const Outcome outcome =
      refine(folder, rows, "--sensor sensor.yaml --correct range-offsets --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json offsets = json::parse(outcome.out)["refinement"]["range_offsets_m"];
  ASSERT_EQ(offsets.size(), 8U);
  // All receivers hang on one side: what they have in common is seen least.
  for (const json& offset : offsets) EXPECT_NEAR(offset.get<double>(), 0.7e-3, 0.15e-3);
}

// One receiver of four reads 3 mm too far: no range meets the others until that is found.
TEST(RefinedRanges, find_an_offset_by_which_ranges_do_not_meet) {
  const Folder folder;
  write_file(folder / "sensor.yaml",
             "armsig: sensor/1\nname: four receivers\nreceivers:\n"
             "  - {x_mm: -750, y_mm: 2000, z_mm: -300}\n  - {x_mm: 750, y_mm: 2000, z_mm: -300}\n"
             "  - {x_mm: -750, y_mm: 2000, z_mm: 1200}\n  - {x_mm: 750, y_mm: 2300, z_mm: 1200}\n"
             "path: one-way\nrange_sigma_mm: 0.05\n");
  ASSERT_EQ(run_tool(folder,
                     "simulate --arm puma560 --sensor sensor.yaml --sigma-mm 0.05 --tolerances 1 "
                     "--flange-target-mm 80,30,120 --arc 150 --seed 3 --free-poses 100 --out m.csv")
                .status,
            0);
  Csv rows = Csv::read(folder / "m.csv");
  for (Fields& row : rows.rows) {
    std::string& range = row[rows.column("r1_mm")];
    range = std::to_string(std::stod(range) + 3);
  }
  rows.write(folder / "m.csv");
  const Outcome outcome =
      run_tool(folder,
               "identify --arm puma560 --measurements m.csv --sensor sensor.yaml --method refined "
               "--correct range-offsets --out s.yaml --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json result = json::parse(outcome.out);
  EXPECT_NEAR(result["refinement"]["range_offsets_m"][0].get<double>(), 3e-3, 0.3e-3);
  EXPECT_LT(result["predicted_tool_error_m"], 0.3e-3);
  EXPECT_EQ(outcome.err.find("bends"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace armsig::cli
