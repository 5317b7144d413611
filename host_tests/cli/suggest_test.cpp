// SPDX-License-Identifier: MIT
// `suggest` and `predict --sigma` as a user meets them: what a covariance is good for.
#include <nlohmann/json.hpp>

#include "host_tests/cli/identified_arm.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

TEST(Predict, adds_the_sigma_of_every_pose) {
  const Folder folder;
  const Csv held = identified(folder);
  write_joint_poses(held, folder / "q.csv");
  const Outcome outcome =
      run_tool(folder, "predict --signature s.yaml --joints q.csv --target 1 --sigma --out p.csv");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Csv poses = Csv::read(folder / "p.csv");
  for (std::size_t k = 0; k < poses.rows.size(); ++k) {
    const double sum = std::hypot(poses.number(k, "sigma_x_m"), poses.number(k, "sigma_y_m"),
                                  poses.number(k, "sigma_z_m"));
    EXPECT_GT(poses.number(k, "sigma_x_m"), 1e-5);
    EXPECT_LT(sum, 1e-3);
    EXPECT_NEAR(poses.number(k, "sigma_m"), sum, 1e-12);
  }
  // What it has written can be solved.
  EXPECT_EQ(run_tool(folder,
                     "solve --signature s.yaml --poses p.csv --seed q.csv --target 1 --out "
                     "back.csv")
                .status,
            0);
}

TEST(Predict, takes_a_sigma_for_that_of_the_only_target_on_the_last_link) {
  const Folder folder;
  Csv held = identified(folder);
  write_joint_poses(held, folder / "q.csv");
  const std::string sigma = "predict --signature s.yaml --joints q.csv --sigma --out p.csv";
  const Outcome one = run_tool(folder, sigma);
  EXPECT_EQ(one.status, 0) << one.err;
  EXPECT_NE(one.out.find("poses of target 1"), std::string::npos) << one.out;
  // Every second row of another target beside the first, as it were.
  for (std::size_t k = 0; k < held.rows.size(); k += 2)
    held.rows[k][held.column("target")] = std::string("2");
  held.write(folder / "m.csv");
  ASSERT_EQ(
      run_tool(folder, "identify --arm arm.yaml --measurements m.csv --method refined --out s.yaml")
          .status,
      0);
  const Outcome two = run_tool(folder, sigma);
  EXPECT_EQ(two.status, 2);
  EXPECT_NE(two.err.find("--target with 1 or 2"), std::string::npos) << two.err;
}

TEST(Predict, refuses_a_sigma_without_a_covariance) {
  const Folder folder;
  const Csv held = identified(folder);
  write_joint_poses(held, folder / "q.csv");
  EXPECT_EQ(run_tool(folder,
                     "predict --signature truth.yaml --joints q.csv --target 1 --sigma --out p.csv")
                .status,
            2);
  EXPECT_FALSE(std::filesystem::exists(folder / "p.csv"));
}

TEST(Suggest, gives_poses_inside_the_limits_and_what_each_buys) {
  const Folder folder;
  identified(folder);
  const Outcome outcome =
      run_tool(folder, "suggest --signature s.yaml --count 5 --out next.csv --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json result = json::parse(outcome.out);
  double before_m = result["predicted_rms_m"];
  for (const double after_m : result["predicted_rms_m_after"]) {
    EXPECT_LT(after_m, before_m);
    before_m = after_m;
  }
  const Csv next = Csv::read(folder / "next.csv");
  // Some rows may be the signature configuration, to be gone through.
  std::size_t measured = 0;
  for (std::size_t k = 0; k < next.rows.size(); ++k) {
    if (std::abs(next.number(k, "q3_deg") - 90) > 1e-6) ++measured;
  }
  ASSERT_EQ(measured, 5U);
  for (std::size_t k = 0; k < next.rows.size(); ++k) {
    EXPECT_LE(std::abs(next.number(k, "q1_deg")), 160);
    EXPECT_LE(std::abs(next.number(k, "q5_deg")), 100);
  }
  EXPECT_NE(
      run_tool(folder, "suggest --signature s.yaml --count 2 --out next.csv").out.find("Expected"),
      std::string::npos);
}

TEST(Suggest, stays_where_the_sensor_sees_the_target) {
  const Folder folder;
  identified(folder);
  const Outcome outcome = run_tool(
      folder,
      "suggest --signature s.yaml --count 4 --out q.csv --seen-mm=-3000,-3000,-3000,3000,3000,0");
  if (outcome.status == 0) {
    const Csv poses = predict(folder, "s.yaml", "1");
    for (std::size_t k = 0; k < poses.rows.size(); ++k) EXPECT_LE(poses.number(k, "z_m"), 0);
  }
  const Outcome nowhere = run_tool(
      folder, "suggest --signature s.yaml --out q.csv --seen-mm=9000,9000,9000,9100,9100,9100");
  EXPECT_EQ(nowhere.status, 1);
  EXPECT_NE(nowhere.err.find("box"), std::string::npos) << nowhere.err;
}

TEST(Suggest, keeps_the_whole_arm_in_the_box) {
  const Folder folder;
  identified(folder);
  const std::string suggest = "suggest --signature s.yaml --count 4 --out q.csv ";
  const Outcome inside = run_tool(folder, suggest + "--box-mm=-700,-700,-600,700,700,1200");
  EXPECT_EQ(inside.status, 0) << inside.err;
  const Outcome outside = run_tool(folder, suggest + "--box-mm=-700,-700,-600,700,700,800");
  EXPECT_EQ(outside.status, 1);
  EXPECT_NE(outside.err.find("in the signature configuration link "), std::string::npos)
      << outside.err;
  EXPECT_NE(outside.err.find("beyond the box; it ends at"), std::string::npos) << outside.err;
}

TEST(Suggest, says_when_what_was_measured_will_do) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  ASSERT_EQ(run_tool(folder,
                     "simulate --arm arm.yaml --flange-target-mm 80,30,120 --arc 300 --points 100 "
                     "--sigma-mm 0.2 --free-poses 100 --out m.csv")
                .status,
            0);
  ASSERT_EQ(
      run_tool(folder, "identify --arm arm.yaml --measurements m.csv --method refined --out s.yaml")
          .status,
      0);
  const Outcome outcome = run_tool(folder, "suggest --signature s.yaml --count 1 --out n.csv");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("what was measured already will do"), std::string::npos)
      << outcome.out;
}

TEST(Suggest, refuses_a_signature_without_a_covariance) {
  const Folder folder;
  identified(folder);
  EXPECT_EQ(run_tool(folder, "suggest --signature truth.yaml --out n.csv").status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "n.csv"));
}

}  // namespace
}  // namespace armsig::cli
