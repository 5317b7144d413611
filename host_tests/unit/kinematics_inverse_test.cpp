// SPDX-License-Identifier: MIT
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/kinematics/inverse.hpp"
#include "host_tests/support/kinematics_random.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::kinematics {
namespace {

Chain puma() { return make_chain(test::puma560().joints, test::puma560().limits); }
const JointVector kReady{0.2, -0.8, 0.9, 0.3, 0.7, -0.4};

FixedVector<DhJoint, kMaxJoints> first_rows(std::size_t count) {
  FixedVector<DhJoint, kMaxJoints> rows = test::puma560().joints;
  rows.resize(count);
  return rows;
}

TEST(Inverse, finds_the_readings_that_made_the_pose) {
  JointVector seed = kReady;
  for (double& reading : seed) reading += radians(0.5);
  const InverseSolution solution = *inverse(puma(), *forward(puma(), kReady), seed);
  EXPECT_EQ(solution.verdict, Verdict::kConverged);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(solution.q[i], kReady[i], 1e-9);
  EXPECT_LE(solution.iterations, 4);
  EXPECT_EQ(solution.position_dimensions, 3);
  EXPECT_EQ(solution.rotation_dimensions, 3);
}

TEST(Inverse, refuses_a_pose_or_a_seed_that_is_not_finite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Pose X = *forward(puma(), kReady);
  X.p.y() = nan;
  EXPECT_EQ(inverse(puma(), X, kReady).error(), Error::kNotFinite);
  X = *forward(puma(), kReady);
  X.R(2, 1) = nan;
  EXPECT_EQ(inverse(puma(), X, kReady).error(), Error::kNotFinite);
  JointVector seed = kReady;
  seed[3] = nan;
  EXPECT_EQ(inverse(puma(), *forward(puma(), kReady), seed).error(), Error::kNotFinite);
}

TEST(Inverse, says_that_a_pose_is_out_of_reach_and_comes_as_near_as_it_can) {
  Pose X = *forward(puma(), kReady);
  X.p = X.p.normalized() * 1.5;
  const InverseSolution solution = *inverse(make_chain(test::puma560().joints), X, kReady);
  EXPECT_EQ(solution.verdict, Verdict::kOutOfReach);
  // The wrist of the Puma is at most |(0.4318 + 0.4312, 0.14909)| from its base.
  EXPECT_NEAR(solution.position_error_m, 1.5 - 0.8758, 2e-3);
}

TEST(Inverse, says_that_a_joint_limit_is_in_the_way_and_stays_inside) {
  const test::KnownArm arm = test::puma560();
  const Chain chain = puma();
  JointVector beyond = kReady;
  beyond[4] = arm.limits[4].upper + 0.05;
  JointVector seed = kReady;
  seed[4] = arm.limits[4].upper - 0.05;
  const InverseSolution solution = *inverse(chain, *forward(chain, beyond), seed);
  EXPECT_EQ(solution.verdict, Verdict::kJointLimit);
  EXPECT_LE(solution.q[4], arm.limits[4].upper);
}

TEST(Inverse, can_leave_the_limits_aside) {
  JointVector beyond = kReady;
  beyond[4] = test::puma560().limits[4].upper + 0.05;
  const InverseOptions options{.respect_limits = false};
  const InverseSolution solution = *inverse(puma(), *forward(puma(), beyond), kReady, options);
  EXPECT_EQ(solution.verdict, Verdict::kConverged);
}

TEST(Inverse, says_that_the_step_is_limited_and_goes_no_further) {
  JointVector goal = kReady;
  goal[0] += 0.1;
  InverseOptions options;
  options.max_step = JointVector(6, 0.02);
  const InverseSolution solution = *inverse(puma(), *forward(puma(), goal), kReady, options);
  EXPECT_EQ(solution.verdict, Verdict::kStepLimit);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_LE(std::abs(solution.q[i] - kReady[i]), 0.02);
}

TEST(Inverse, moves_a_seed_outside_the_limits_towards_them_by_no_more_than_a_step) {
  JointVector seed = kReady;
  seed[0] = test::puma560().limits[0].upper + 0.5;
  InverseOptions options;
  options.max_step = JointVector(6, 0.02);
  const InverseSolution solution = *inverse(puma(), *forward(puma(), kReady), seed, options);
  EXPECT_NEAR(solution.q[0], seed[0] - 0.02, 1e-12);
}

TEST(Inverse, is_degraded_where_the_wrist_is_straight) {
  JointVector q = kReady;
  q[4] = 1e-9;
  JointVector seed = q;
  for (double& reading : seed) reading += 0.003;
  const InverseSolution solution = *inverse(puma(), *forward(puma(), q), seed);
  EXPECT_EQ(solution.verdict, Verdict::kDegraded);
  EXPECT_LT(solution.position_error_m, 1e-9);
  EXPECT_LT(solution.rotation_error_rad, 1e-9);
}

TEST(Inverse, stops_at_the_iterations_it_was_given) {
  JointVector seed = kReady;
  seed[1] -= 1.0;
  seed[3] += 1.0;
  const InverseOptions options{.max_iterations = 3};
  const InverseSolution solution = *inverse(puma(), *forward(puma(), kReady), seed, options);
  EXPECT_EQ(solution.verdict, Verdict::kNotConverged);
  EXPECT_LE(solution.iterations, 3);
}

TEST(InverseOfAScara, meets_the_pose_and_says_which_dimensions_it_can_meet) {
  const test::KnownArm arm = test::cobra600();
  const Chain chain = make_chain(arm.joints, arm.limits);
  const JointVector q{0.3, 0.5, 0.1, -0.4};
  const InverseSolution solution = *inverse(chain, *forward(chain, q), {0.25, 0.55, 0.12, -0.35});
  EXPECT_EQ(solution.verdict, Verdict::kConverged);
  EXPECT_EQ(solution.position_dimensions, 3);
  EXPECT_EQ(solution.rotation_dimensions, 1);
  EXPECT_LT(solution.rotation_error_rad, 1e-9);
}

TEST(InverseOfAScara, meets_the_position_first_where_the_orientation_cannot_be_met) {
  const test::KnownArm arm = test::cobra600();
  const Chain chain = make_chain(arm.joints, arm.limits);
  const JointVector q{0.3, 0.5, 0.1, -0.4};
  Pose X = *forward(chain, q);
  X.R = X.R * rotation_x(0.2);
  const InverseSolution solution = *inverse(chain, X, {0.25, 0.55, 0.12, -0.35});
  EXPECT_EQ(solution.verdict, Verdict::kConverged);
  EXPECT_LT(solution.position_error_m, 1e-9);
  EXPECT_NEAR(solution.rotation_error_rad, 0.2, 1e-6);
}

TEST(InverseOfThreeJoints, meets_the_position_and_gives_up_the_orientation) {
  const Chain chain = make_chain(first_rows(3));
  Pose X = *forward(chain, {0.3, -0.5, 0.8});
  X.R = X.R * rotation_z(0.3);
  // The wrist point stands off the last frame; its position alone is asked for.
  const InverseSolution solution = *inverse(chain, X, {0.2, -0.4, 0.7});
  EXPECT_EQ(solution.verdict, Verdict::kConverged);
  EXPECT_LT(solution.position_error_m, 1e-9);
}

TEST(InverseOfThreeJoints, meets_the_position_of_the_point_that_it_is_asked_for) {
  const Chain chain = make_chain(first_rows(3));
  Pose X = *forward(chain, {0.3, -0.5, 0.8});
  X.R = X.R * rotation_z(0.05);
  const InverseOptions at_tool{.p_nP = {0.02, 0.1, 0.3}};
  const InverseSolution solution = *inverse(chain, X, {0.2, -0.4, 0.7}, at_tool);
  EXPECT_EQ(solution.verdict, Verdict::kConverged);
  EXPECT_LT((*forward(chain, solution.q) * at_tool.p_nP - X * at_tool.p_nP).norm(), 1e-9);
  EXPECT_GT(solution.rotation_error_rad, 0.01);
}

TEST(InverseOfOneJoint, turns_as_near_as_it_can) {
  FixedVector<DhJoint, kMaxJoints> rows{{JointType::kRevolute, 0, 0, 0.5, 0}};
  const Chain chain = make_chain(rows);
  const InverseSolution solution = *inverse(chain, *forward(chain, {0.7}), {0.1});
  EXPECT_EQ(solution.verdict, Verdict::kConverged);
  EXPECT_NEAR(solution.q[0], 0.7, 1e-9);
  EXPECT_EQ(solution.position_dimensions, 1);
}

TEST(InverseOfSevenJoints, takes_the_solution_nearest_to_the_seed) {
  const test::KnownArm arm = test::iiwa7();
  const Chain chain = make_chain(arm.joints, arm.limits);
  const JointVector seed{0.3, 0.6, -0.4, -1.2, 0.5, 0.9, 0.1};
  JointVector moved = seed;
  for (std::size_t i = 0; i < 7; ++i) moved[i] += 0.03 * (i % 2 == 0 ? 1 : -1);
  const InverseSolution solution = *inverse(chain, *forward(chain, moved), seed);
  ASSERT_EQ(solution.verdict, Verdict::kConverged);
  // At the nearest solution the way back to the seed has no part along the self-motion, which is
  // the kernel of the Jacobian.
  const PoseAndJacobian at = *forward_with_jacobian(chain, solution.q);
  Eigen::Matrix<double, 7, 1> back;
  double squared = 0;
  double squared_moved = 0;
  for (std::size_t i = 0; i < 7; ++i) {
    back[static_cast<Eigen::Index>(i)] = seed[i] - solution.q[i];
    squared += (seed[i] - solution.q[i]) * (seed[i] - solution.q[i]);
    squared_moved += (seed[i] - moved[i]) * (seed[i] - moved[i]);
  }
  const Eigen::Matrix<double, 6, 7> J = at.J.leftCols<7>();
  const Eigen::Matrix<double, 7, 1> kernel = J.jacobiSvd(Eigen::ComputeFullV).matrixV().col(6);
  EXPECT_NEAR(kernel.dot(back), 0, 1e-7);
  EXPECT_LE(squared, squared_moved);
}

}  // namespace
}  // namespace armsig::kinematics
