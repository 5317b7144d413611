// SPDX-License-Identifier: MIT
// The table of what is different about an arm, where a user meets it.
#include <cmath>
#include <span>

#include <nlohmann/json.hpp>

#include "core/base/links.hpp"
#include "core/base/low_discrepancy.hpp"
#include "firmware/analysis/starts/base_and_tool.hpp"
#include "host_tests/cli/predictions.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::cli {
namespace {

using Json = nlohmann::json;

// The Puma with one row changed, identified from its sweeps and poses.
Outcome identified(const Folder& folder, const std::string& from, const std::string& to,
                   const std::string& options) {
  write_file(folder / "arm.yaml", kPuma560);
  std::string built = kPuma560;
  const std::size_t at = built.find(from);
  EXPECT_NE(at, std::string::npos);
  built.replace(at, from.size(), to);
  write_file(folder / "built.yaml", built);
  EXPECT_EQ(run_tool(folder,
                     "simulate --arm arm.yaml --truth built.yaml --sigma-mm 0.05 "
                     "--flange-target-mm 80,30,120 --arc 150 --points 30 --free-poses 30 "
                     "--seed 2 --out m.csv")
                .status,
            0);
  const Outcome outcome =
      run_tool(folder, "identify --arm arm.yaml --measurements m.csv --out s.yaml " + options);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return outcome;
}

TEST(DifferenceTable, says_which_joint_differs_and_what_that_does) {
  for (const std::string method : {"--method encoder", "--method refined"}) {
    SCOPED_TRACE(method);
    const Folder folder;
    // The elbow 1 mm further out.
    const Json table =
        Json::parse(identified(folder, "a_mm: 431.8", "a_mm: 432.8", method + " --json").out);
    const Json& differences = table["differences"];
    double sum = 0;
    bool found = false;
    for (const Json& line : differences["joints"]) {
      sum += line["adds_m"].get<double>();
      const bool planted = line["joint"] == 3 && line["what"] == "shift away from axis 2";
      found = found || planted;
      const char* value = line.contains("value_m") ? "value_m" : "value_rad";
      const char* sigma = line.contains("value_m") ? "sigma_m" : "sigma_rad";
      EXPECT_NEAR(line[value].get<double>(), planted ? 1e-3 : 0.0, 4 * line[sigma].get<double>())
          << line;
      EXPECT_GT(line["effect_rms_m"].get<double>(), 0);
    }
    EXPECT_TRUE(found);
    const double total_m = differences["total_rms_m"].get<double>();
    EXPECT_NEAR(sum, total_m, 1e-3 * total_m);
    EXPECT_NEAR(total_m, 0.9e-3, 0.2e-3);
  }
}

TEST(DifferenceTable, is_printed_for_a_person) {
  const Folder folder;
  const Outcome outcome = identified(folder, "theta_deg: 0, d_mm: 430.7",
                                     "theta_deg: 0.3, d_mm: 430.7", "--method encoder");
  EXPECT_NE(outcome.out.find("What is different from the nominal model"), std::string::npos);
  EXPECT_NE(outcome.out.find("tilt about the link from axis 2 to 3"), std::string::npos);
  EXPECT_NE(outcome.out.find("+0.30"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("joint 1 is"), std::string::npos);
}

TEST(DifferenceTable, holds_the_errors_of_the_readings_that_were_found) {
  const Folder folder;
  const Json table = Json::parse(
      identified(folder, "a_mm: 431.8", "a_mm: 432.0", "--method refined --correct gain --json")
          .out);
  int scales = 0;
  for (const Json& line : table["differences"]["joints"]) {
    if (line["kind"] != "scale") continue;
    ++scales;
    EXPECT_NEAR(line["value"].get<double>(), 0, 4 * line["sigma"].get<double>());
  }
  EXPECT_EQ(scales, 6);
}

// RMS distance of what s.yaml predicts over the joint limits from the Puma as drawn, its base and
// tool fitted to that.
double distance_from_the_drawing_m(const Folder& folder) {
  constexpr int kPoses = 400;
  const Arm drawing = test::puma560();
  const JointTypes types = types_of(drawing.joints);
  std::vector<calibration::Observation> rows(kPoses);
  std::string poses = "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\n";
  for (int k = 0; k < kPoses; ++k) {
    calibration::Observation& row = rows[static_cast<std::size_t>(k)];
    row.readings = evenly_spread_configuration(types, drawing.limits, k + 1);
    Fields fields;
    for (const double q : row.readings) fields.push_back(std::to_string(q));
    poses += join(fields, ',') + "\n";
  }
  write_file(folder / "q.csv", poses);
  const Csv points = predict(folder, "s.yaml", "1");
  for (std::size_t k = 0; k < rows.size(); ++k) {
    rows[k].p_S = {points.number(k, "x_m"), points.number(k, "y_m"), points.number(k, "z_m")};
  }
  const Target tool{.number = 1, .link = drawing.joints.size()};
  const auto fitted = calibration::fit_base_and_tool(drawing, rows, std::span(&tool, 1));
  EXPECT_TRUE(fitted.has_value());
  if (!fitted) return 0;
  double squares = 0;
  for (const calibration::Observation& row : rows) {
    const Pose X_SL = fitted->X_SB * dh_frames(drawing.joints, row.readings).back();
    squares += (X_SL * fitted->p_LT[0] - row.p_S).squaredNorm() / kPoses;
  }
  return std::sqrt(squares);
}

TEST(DifferenceTable, adds_up_to_what_the_whole_model_does_to_the_tool) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  ASSERT_EQ(run_tool(folder,
                     "simulate --arm arm.yaml --sigma-mm 0.05 --flange-target-mm 80,30,120 "
                     "--maps-deg 0.05 --deflection-mm 1 --free-poses 200 --seed 5 --out m.csv")
                .status,
            0);
  const Outcome outcome = run_tool(
      folder, "identify --arm arm.yaml --measurements m.csv --method refined --out s.yaml --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json differences = Json::parse(outcome.out)["differences"];
  double sum = 0;
  int maps = 0;
  int gravity = 0;
  for (const Json& line : differences["joints"]) {
    sum += line["adds_m"].get<double>();
    maps += line["kind"] == "map" ? 1 : 0;
    gravity += line["kind"] == "gravity" ? 1 : 0;
  }
  EXPECT_EQ(maps, 6);
  EXPECT_GE(gravity, 2);
  const double total_m = differences["total_rms_m"];
  EXPECT_NEAR(sum, total_m, 1e-3 * total_m);
  EXPECT_NEAR(total_m, distance_from_the_drawing_m(folder), 0.05 * total_m);
}

}  // namespace
}  // namespace armsig::cli
