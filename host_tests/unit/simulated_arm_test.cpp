// SPDX-License-Identifier: MIT
#include <cmath>

#include <gtest/gtest.h>

#include "hal/simulated/arm.hpp"
#include "hal/simulated/tolerances.hpp"

namespace armsig::simulated {
namespace {

// Three joints with no zero in them, the middle one prismatic, the last one coupled to the first.
SimulatedArm odd_arm() {
  SimulatedArm arm;
  arm.arm.joints = {{JointType::kRevolute, 0.1, 0.3, 0.05, -1.2},
                    {JointType::kPrismatic, 0.4, 0.2, -0.1, 0.7},
                    {JointType::kRevolute, -0.5, -0.15, 0.4, 1.5}};
  arm.arm.couplings = {{.joint = 2, .from = 0, .ratio = 0.5}};
  arm.X_S0 = {rotation_z(0.7) * rotation_x(-0.2), Vector3(0.1, 0.2, 0.3)};
  return arm;
}

JointVector some_readings() { return {0.6, 0.25, -0.9}; }

// Golden values: numpy, products of the elementary 4 x 4 matrices Rot(z) Trans(z) Trans(x) Rot(x).
TEST(SimulatedArm, link_pose_is_the_product_of_elementary_transforms) {
  const Pose X_S3 = link_pose(odd_arm(), some_readings(), 3);
  const Matrix3 golden{{0.7761616929843668, -0.5680391915986257, 0.27368687062338526},
                       {0.5882718182293916, 0.496130931980971, -0.6385846586074388},
                       {0.22695659104931826, 0.6566472227457245, 0.7192392721755393}};
  EXPECT_LT((X_S3.R - golden).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_LT((X_S3.p - Vector3(0.0257087963881526, 0.466811558714917, 0.7181055354849752)).norm(),
            1e-15);
}

TEST(SimulatedArm, prismatic_reading_moves_along_the_axis_of_its_joint) {
  const Pose X_S2 = link_pose(odd_arm(), some_readings(), 2);
  EXPECT_LT((X_S2.p - Vector3(-0.3668443411735681, 0.29896029525902035, 0.7332047919801803)).norm(),
            1e-15);
  JointVector further = some_readings();
  further[1] += 0.1;
  const Vector3 motion = link_pose(odd_arm(), further, 2).p - X_S2.p;
  EXPECT_LT((motion - 0.1 * link_pose(odd_arm(), some_readings(), 1).R.col(2)).norm(), 1e-15);
}

TEST(SimulatedArm, link_zero_is_the_base) {
  EXPECT_EQ(link_pose(odd_arm(), some_readings(), 0).p, odd_arm().X_S0.p);
}

TEST(SimulatedArm, target_moves_with_its_link) {
  const Target on_tool{.number = 1, .link = 3, .p_L = {0.03, -0.02, 0.11}};
  EXPECT_LT((target_position(odd_arm(), some_readings(), on_tool) -
             Vector3(0.0904599867782285, 0.404292782175361, 0.7908976087008497))
                .norm(),
            1e-15);
  const Target on_link_1{.number = 2, .link = 1, .p_L = {0.1, 0, 0}};
  JointVector moved = some_readings();
  moved[2] += 1;
  EXPECT_EQ(target_position(odd_arm(), some_readings(), on_link_1),
            target_position(odd_arm(), moved, on_link_1));
}

TEST(SimulatedArm, coupling_adds_a_share_of_the_other_reading) {
  const JointVector effective = effective_readings(odd_arm().arm, some_readings());
  EXPECT_EQ(effective[0], 0.6);
  EXPECT_EQ(effective[1], 0.25);
  EXPECT_DOUBLE_EQ(effective[2], -0.6);
}

TEST(SimulatedArm, traps_on_readings_of_another_arm) {
  EXPECT_DEATH((void)link_pose(odd_arm(), {0.1, 0.2}, 1), "");
}

TEST(Tolerances, drawn_arms_scatter_as_stated) {
  constexpr int kCount = 5000;
  const Arm nominal = odd_arm().arm;
  Random random(9);
  DhJoint sum_of_squares;
  for (int i = 0; i < kCount; ++i) {
    const Arm arm = drawn_arm(nominal, {}, random);
    const DhJoint& was = nominal.joints[1];  // the prismatic one
    const DhJoint& is = arm.joints[1];
    ASSERT_EQ(is.type, was.type);
    sum_of_squares.alpha_rad += std::pow(is.alpha_rad - was.alpha_rad, 2);
    sum_of_squares.theta_rad += std::pow(is.theta_rad - was.theta_rad, 2);
    sum_of_squares.a_m += std::pow(is.a_m - was.a_m, 2);
    sum_of_squares.d_m += std::pow(is.d_m - was.d_m, 2);
  }
  EXPECT_NEAR(degrees(std::sqrt(sum_of_squares.alpha_rad / kCount)), 0.1, 0.005);
  EXPECT_NEAR(degrees(std::sqrt(sum_of_squares.theta_rad / kCount)), 0.2, 0.01);
  EXPECT_NEAR(std::sqrt(sum_of_squares.a_m / kCount), 0.5e-3, 0.025e-3);
  EXPECT_NEAR(std::sqrt(sum_of_squares.d_m / kCount), 0.5e-3, 0.025e-3);
}

TEST(Tolerances, of_zero_give_the_nominal_arm_with_its_couplings) {
  Random random(9);
  const Arm arm = drawn_arm(odd_arm().arm, {0, 0, 0, 0}, random);
  EXPECT_EQ(arm.joints[2].alpha_rad, odd_arm().arm.joints[2].alpha_rad);
  EXPECT_EQ(arm.couplings.size(), 1U);
}

TEST(Tolerances, same_seed_draws_the_same_arm) {
  Random a(1, 2);
  Random b(1, 2);
  EXPECT_EQ(drawn_arm(odd_arm().arm, {}, a).joints[0].d_m,
            drawn_arm(odd_arm().arm, {}, b).joints[0].d_m);
}

}  // namespace
}  // namespace armsig::simulated
