// SPDX-License-Identifier: MIT
// The drawings that come with the command: readable, with a source, and of the makers' lengths.
#include "firmware/host_tool/known_arms/known_arms.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"

namespace armsig::tool {
namespace {

// The last frame's origin in the base at all readings zero, by (2) of the paper.
Vector3 tip_at_zero(const Arm& arm) {
  Pose X_BL;
  for (const DhJoint& joint : arm.joints) {
    const Matrix3 R_z = rotation_z(joint.theta_rad);
    X_BL = X_BL * Pose{R_z * rotation_x(joint.alpha_rad), R_z * Vector3(joint.a_m, 0, joint.d_m)};
  }
  return X_BL.p;
}

TEST(KnownArms, all_can_be_read_and_say_where_they_come_from) {
  EXPECT_GE(known_arms().size(), 20U);
  for (const KnownArm& arm : known_arms()) {
    const auto description = parse_arm(arm.text, arm.name);
    ASSERT_TRUE(description) << render(description.error());
    EXPECT_GT(source_of(arm).size(), 20U) << arm.name;
  }
}

// Sums of lengths read off the makers' dimension drawings, all readings zero; their own parameters
// are rounded to micrometres.
TEST(KnownArms, at_zero_they_stand_as_the_makers_draw_them) {
  struct Drawn {
    const char* name;
    double beside_m, height_m;  // from the axis of joint 1, and above the base
  };
  const Drawn drawn[] = {
      {"ur3", std::hypot(0.24365 + 0.21325, 0.11235 + 0.0819), 0.1519 - 0.08535},
      {"ur3e", std::hypot(0.24355 + 0.2132, 0.13105 + 0.0921), 0.15185 - 0.08535},
      {"ur5e", std::hypot(0.425 + 0.3922, 0.1333 + 0.0996), 0.1625 - 0.0997},
      {"ur10", std::hypot(0.612 + 0.5723, 0.163941 + 0.0922), 0.1273 - 0.1157},
      {"ur10e", std::hypot(0.6127 + 0.57155, 0.17415 + 0.11655), 0.1807 - 0.11985},
      {"ur16e", std::hypot(0.4784 + 0.36, 0.17415 + 0.11655), 0.1807 - 0.11985},
      {"ur30", std::hypot(0.637 + 0.5037, 0.201 + 0.1543), 0.2363 - 0.1593},
      {"ur5", std::hypot(0.425 + 0.39225, 0.10915 + 0.0823), 0.089159 - 0.09465},
      {"ur20", std::hypot(0.862 + 0.7287, 0.201 + 0.1543), 0.2363 - 0.1593},
      {"panda", 0.088, 0.333 + 0.316 + 0.384 - 0.107},
      {"fr3", 0.088, 0.333 + 0.316 + 0.384 - 0.107},
      {"iiwa7", 0, 0.34 + 0.4 + 0.4 + 0.126},
      {"puma560", std::hypot(0.4318 - 0.02032, 0.14909), 0.4307},
      {"stanford", 0.154 - 0.0203, 0.412},
      {"cobra600", 0.325 + 0.275, 0.387},
      {"iiwa14", 0, 0.36 + 0.42 + 0.4 + 0.126},
      {"irb120", 0.302 + 0.072, 0.29 + 0.27 + 0.07},
      {"lrmate200id", 0.05 + 0.335 + 0.08, 0.33 + 0.33 + 0.035},
      {"gp7", 0.04 + 0.44 + 0.08, 0.33 + 0.445 + 0.04},
      {"xarm6", 0.207, 0.112},
  };
  for (const Drawn& expected : drawn) {
    const auto arm = read_arm(expected.name);
    ASSERT_TRUE(arm) << render(arm.error());
    const Vector3 tip = tip_at_zero(arm->arm);
    EXPECT_NEAR(std::hypot(tip.x(), tip.y()), expected.beside_m, 5e-6) << expected.name;
    EXPECT_NEAR(tip.z(), expected.height_m, 5e-6) << expected.name;
  }
  // Their base frames stand upside down.
  for (const auto& [name, reach_m] : {std::pair{"kr6-r700", 0.025 + 0.315 + 0.365 + 0.08},
                                      std::pair{"kr6-r900", 0.025 + 0.455 + 0.42 + 0.08}}) {
    const auto kuka = read_arm(name);
    ASSERT_TRUE(kuka);
    EXPECT_NEAR(tip_at_zero(kuka->arm).x(), reach_m, 1e-9) << name;
    EXPECT_NEAR(tip_at_zero(kuka->arm).z(), -(0.4 + 0.035), 1e-9) << name;
  }
  EXPECT_EQ(std::size(drawn) + 2, known_arms().size()) << "an arm that is held against nothing";
}

}  // namespace
}  // namespace armsig::tool
