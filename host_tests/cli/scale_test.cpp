// SPDX-License-Identifier: MIT
// A scale of the sensor that is within what a workshop may build: where the drawing's lengths show
// it, it is said, and part of the predicted tool error.
#include <cmath>

#include <nlohmann/json.hpp>

#include "host_tests/cli/predictions.hpp"

namespace armsig::cli {
namespace {

Csv poses_of_a_ur10e(const Folder& folder) {
  const Outcome outcome = run_tool(folder,
                                   "simulate --arm ur10e --tolerances 1 --points 8 --free-poses 80 "
                                   "--flange-target-mm 100,50,150 "
                                   "--sigma-mm 0.05 --seed 4 --out m.csv --truth-out truth.yaml");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return Csv::read(folder / "m.csv");
}

Csv times(Csv rows, double factor) {
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
      rows.rows[k][rows.column(axis)] = std::to_string(factor * rows.number(k, axis));
    }
  }
  return rows;
}

// Of the points about their middle, as the place of the base is the user's choice.
double observed_about_middle_m(const Folder& folder) {
  Csv found = predict(folder, "s.yaml", "1");
  const Csv truth = predict(folder, "truth.yaml", "1");
  for (const char* axis : {"x_m", "y_m", "z_m"}) {
    double apart = 0;
    for (std::size_t k = 0; k < truth.rows.size(); ++k) {
      apart += found.number(k, axis) - truth.number(k, axis);
    }
    apart /= static_cast<double>(truth.rows.size());
    for (std::size_t k = 0; k < truth.rows.size(); ++k) {
      found.rows[k][found.column(axis)] = std::to_string(found.number(k, axis) - apart);
    }
  }
  return rms_distance(found, truth);
}

struct JudgedScale {
  double stated_m = 0;
  double sigma_m = 0;  // by the covariance that the signature holds
  double observed_m = 0;
  std::string err;
};

JudgedScale judge_scale(const Folder& folder, const Csv& rows) {
  rows.write(folder / "m.csv");
  const Outcome outcome = run_tool(
      folder, "identify --arm ur10e --measurements m.csv --method refined --out s.yaml --json");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  if (outcome.status != 0) return {};
  write_joint_poses(rows, folder / "q.csv");
  const Outcome predicted = run_tool(
      folder, "predict --signature s.yaml --joints q.csv --target 1 --sigma --out p.csv --json");
  return {nlohmann::json::parse(outcome.out)["predicted_tool_error_m"].get<double>(),
          nlohmann::json::parse(predicted.out)["rms_sigma_m"].get<double>(),
          observed_about_middle_m(folder), outcome.err};
}

TEST(Scale, is_part_of_the_predicted_error_where_the_drawing_shows_it) {
  const Folder folder;
  const Csv rows = poses_of_a_ur10e(folder);
  const JudgedScale sound = judge_scale(folder, rows);
  EXPECT_EQ(sound.err.find("all lengths seen"), std::string::npos) << sound.err;
  EXPECT_LT(sound.stated_m, 0.2e-3);
  EXPECT_LT(sound.observed_m, 1.5 * sound.stated_m);
  const JudgedScale stretched = judge_scale(folder, times(rows, 1.002));
  EXPECT_NE(stretched.err.find("all lengths seen are 1.00"), std::string::npos) << stretched.err;
  EXPECT_NE(stretched.err.find("part of the predicted tool error"), std::string::npos);
  EXPECT_GT(stretched.observed_m, 1e-3);
  EXPECT_LT(stretched.observed_m, 1.5 * stretched.stated_m);  // far more without
  EXPECT_GT(stretched.observed_m, 0.5 * stretched.stated_m);
  EXPECT_NEAR(stretched.sigma_m, stretched.stated_m, 0.2 * stretched.stated_m);
}

// How long a millimetre is, a slide's reading says as well as the sensor: one of them errs.
TEST(Scale, is_part_of_the_predicted_error_where_a_slide_contradicts_it) {
  const Folder folder;
  const Outcome outcome = run_tool(
      folder,
      "simulate --arm stanford --tolerances 1 --points 24 --flange-target-mm 100,50,150 --sigma-mm "
      "0.05 --seed 4 --out m.csv --truth-out truth.yaml");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  times(Csv::read(folder / "m.csv"), 1.002).write(folder / "m.csv");
  for (const std::string method : {"encoder", "refined"}) {
    const Outcome found = run_tool(
        folder,
        "identify --arm stanford --measurements m.csv --out s.yaml --json --method " + method);
    ASSERT_EQ(found.status, 0) << found.err;
    EXPECT_NE(found.err.find("joint 3 is seen to go 1.00"), std::string::npos) << found.err;
    const auto result = nlohmann::json::parse(found.out);
    EXPECT_GT(result["predicted_tool_error_m"], 0.5e-3) << method;  // 0.1 mm by noise alone
    EXPECT_FALSE(result.contains("moved_by_100_ppm_scale_m"));
  }
}

// What no row tells is said beside what is stated.
TEST(Scale, of_the_sensor_is_named_as_no_part_of_the_predicted_error_of_turning_joints) {
  const Folder folder;
  poses_of_a_ur10e(folder);
  const std::string identify =
      "identify --arm ur10e --measurements m.csv --method refined --out s.yaml";
  const Outcome found = run_tool(folder, identify);
  EXPECT_NE(found.out.find("not in it: the scale of the sensor"), std::string::npos) << found.out;
  const auto result = nlohmann::json::parse(run_tool(folder, identify + " --json").out);
  // A ten-thousandth of a metre's reach, base and tool fitted.
  EXPECT_GT(result["moved_by_100_ppm_scale_m"], 0.02e-3);
  EXPECT_LT(result["moved_by_100_ppm_scale_m"], 0.15e-3);
}

}  // namespace
}  // namespace armsig::cli
