// SPDX-License-Identifier: MIT
// Where `plan` and `suggest` send every known arm, pose by pose and on the ways between, by a
// forward kinematics that is not the command's: nothing of the arm, nor its target, goes below the
// mounting plane or the floor.
#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "host_tests/cli/identified_arm.hpp"
#include "host_tests/support/kinematics_reference.hpp"

namespace armsig::cli {
namespace {

using tool::ArmDescription;

ArmDescription described(const tool::KnownArm& arm) { return *tool::parse_arm(arm.text, arm.name); }

// Which way is off the mounting plane, and how far below it the floor is: read off the files.
double side(const ArmDescription& arm) { return arm.arm.joints[0].d_m < 0 ? -1 : 1; }

// Height over the floor of the lowest of origins 2 ... n and the target, and the least distance of
// no use: of origin 1, which the mounting holds.
double lowest(const ArmDescription& arm, const JointVector& q, const Vector3& p_nT = {0, 0, 0}) {
  const JointVector effective = effective_readings(arm.arm, q);
  double least = 1e9;
  for (std::size_t n = 2; n <= arm.arm.joints.size(); ++n) {
    DhRows first;
    for (std::size_t i = 0; i < n; ++i) first.push_back(arm.arm.joints[i]);
    const auto T = test::reference_pose(first, effective);
    double z = static_cast<double>(T[2][3]);
    least = std::min(least, side(arm) * z);
    if (n < arm.arm.joints.size()) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      z += static_cast<double>(T[2][k]) * p_nT[static_cast<Eigen::Index>(k)];
    }
    least = std::min(least, side(arm) * z);
  }
  return least + arm.mounting.floor_m.value_or(0);
}

std::vector<JointVector> readings_of(const Csv& poses, const ArmDescription& arm) {
  std::vector<JointVector> all;
  for (std::size_t row = 0; row < poses.rows.size(); ++row) {
    JointVector q;
    for (std::size_t j = 0; j < arm.arm.joints.size(); ++j) {
      const bool turns = arm.arm.joints[j].type == JointType::kRevolute;
      const double value = poses.number(row, poses.header[j]);
      q.push_back(turns ? radians(value) : 1e-3 * value);
    }
    all.push_back(q);
  }
  return all;
}

// Of the poses and of 60 places between each two.
void expect_above(const ArmDescription& arm, const std::vector<JointVector>& poses,
                  const Vector3& p_nT) {
  constexpr int kPlaces = 60;
  int below = 0;
  double least = 1e9;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const JointVector& from = poses[k == 0 ? 0 : k - 1];
    for (int place = 1; place <= kPlaces; ++place) {
      JointVector q = from;
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += (poses[k][j] - from[j]) * place / kPlaces;
      const double height = lowest(arm, q, p_nT);
      least = std::min(least, height);
      if (height < 0) ++below;
    }
    for (std::size_t j = 0; j < poses[k].size(); ++j) {
      EXPECT_GE(poses[k][j], arm.arm.limits[j].lower - 1e-9);
      EXPECT_LE(poses[k][j], arm.arm.limits[j].upper + 1e-9);
    }
  }
  EXPECT_EQ(below, 0) << "down to " << 1e3 * least << " mm";
}

TEST(ClearPoses, of_every_known_arm_are_planned_above_its_mounting_plane) {
  for (const tool::KnownArm& known : tool::known_arms()) {
    SCOPED_TRACE(known.name);
    const Folder folder;
    const Outcome outcome = run_tool(folder, "plan --arm " + std::string(known.name) +
                                                 " --target-mm 60,20,80 --json --out p.csv");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const ArmDescription arm = described(known);
    const auto poses = readings_of(Csv::read(folder / "p.csv"), arm);
    EXPECT_GE(poses.size(), 24 * arm.arm.joints.size());
    expect_above(arm, poses, {0.06, 0.02, 0.08});
    // And the sweeps are good ones.
    const auto sweeps = nlohmann::json::parse(outcome.out)["sweeps"];
    for (std::size_t j = 0; j < sweeps.size(); ++j) {
      if (arm.arm.joints[j].type != JointType::kRevolute) continue;
      const double arc = sweeps[j]["last"].get<double>() - sweeps[j]["first"].get<double>();
      const auto [lower, upper] = arm.arm.limits[j];
      EXPECT_GE(arc, std::min(radians(120), upper - lower - radians(5))) << "joint " << j + 1;
    }
  }
}

TEST(ClearPoses, of_every_known_arm_are_suggested_above_its_mounting_plane) {
  for (const tool::KnownArm& known : tool::known_arms()) {
    SCOPED_TRACE(known.name);
    const Folder folder;
    const std::string name(known.name);
    const ArmDescription arm = described(known);
    std::string at;
    for (std::size_t j = 0; j < arm.sweep_at.size(); ++j) {
      const bool turns = arm.arm.joints[j].type == JointType::kRevolute;
      at += (j == 0 ? "" : ",") +
            std::to_string(turns ? degrees(arm.sweep_at[j]) : 1e3 * arm.sweep_at[j]);
    }
    ASSERT_EQ(run_tool(folder, "simulate --arm " + name + " --configuration " + at +
                                   " --flange-target-mm 60,20,80 --points 8 --sigma-mm 0.1 --out "
                                   "m.csv")
                  .status,
              0);
    const Outcome identified = run_tool(
        folder, "identify --arm " + name + " --measurements m.csv --method refined --out s.yaml");
    ASSERT_EQ(identified.status, 0) << identified.err;
    const Outcome outcome = run_tool(folder, "suggest --signature s.yaml --count 30 --out p.csv");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto poses = readings_of(Csv::read(folder / "p.csv"), arm);
    EXPECT_GE(poses.size(), 30U);
    expect_above(arm, poses, {0.06, 0.02, 0.08});
  }
}

// On a ceiling or a wall the plane that the base is bolted to stays what it is.
TEST(ClearPoses, of_an_arm_on_ceiling_or_wall_keep_to_its_side_of_the_mounting_plane) {
  for (const char* const mounted : {"ceiling", "wall", "{gravity: [0, -1, -0.2]}"}) {
    SCOPED_TRACE(mounted);
    const Folder folder;
    const ArmDescription arm = described(*tool::find_known_arm("ur5"));
    write_file(folder / "arm.yaml",
               std::string(tool::find_known_arm("ur5")->text) + "mounted: " + mounted + "\n");
    const Outcome outcome = run_tool(folder, "plan --arm arm.yaml --out p.csv");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    expect_above(arm, readings_of(Csv::read(folder / "p.csv"), arm), {0, 0, 0});
    EXPECT_NE(outcome.out.find("mounting plane"), std::string::npos);
  }
}

TEST(ClearPoses, keep_to_the_floor_of_the_hall_too) {
  const Folder folder;
  const ArmDescription arm = described(*tool::find_known_arm("ur5"));
  write_file(folder / "arm.yaml",
             std::string(tool::find_known_arm("ur5")->text) + "mounted: ceiling\nfloor_mm: 900\n");
  const Outcome outcome = run_tool(folder, "plan --arm arm.yaml --arc 120 --out p.csv");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto poses = readings_of(Csv::read(folder / "p.csv"), arm);
  expect_above(arm, poses, {0, 0, 0});
  for (const JointVector& q : poses) {
    const auto T = test::reference_pose(arm.arm.joints, q);
    EXPECT_LT(static_cast<double>(T[2][3]), 0.9) << "z points down";
  }
}

}  // namespace
}  // namespace armsig::cli
