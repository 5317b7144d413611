// SPDX-License-Identifier: MIT
// The inverse of arms other than those with six joints and a turning wrist.
#include <cmath>
#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/kinematics/inverse.hpp"
#include "firmware/analysis/postures/closed_form.hpp"
#include "host_tests/support/kinematics_random.hpp"
#include "host_tests/support/ready_puma.hpp"

namespace armsig::kinematics {
namespace {

// Three parallel revolute joints, then three prismatic ones: they turn the tool about one axis.
TEST(InverseOfPrismaticWrist, meets_what_it_says_it_meets) {
  DhRows rows;
  for (int i = 0; i < 3; ++i) rows.push_back({JointType::kRevolute, 0, 0, 0.3, 0});
  for (int i = 0; i < 3; ++i) rows.push_back({JointType::kPrismatic, kPi / 2, 0, 0, kPi / 2});
  const Chain chain = make_chain(rows);
  EXPECT_EQ(closed_form(chain).design, Design::kOther);
  std::mt19937_64 random(9);
  int met = 0;
  for (int k = 0; k < 500; ++k) {
    JointVector q;
    JointVector seed;
    for (std::size_t i = 0; i < 6; ++i) q.push_back(test::uniform(random, -1, 1));
    for (const double reading : q) seed.push_back(reading + test::uniform(random, -0.2, 0.2));
    const Pose X = *forward(chain, q);
    const auto solution = inverse(chain, X, seed);
    ASSERT_TRUE(solution.has_value());
    if (solution->verdict != Verdict::kConverged && solution->verdict != Verdict::kDegraded) {
      continue;
    }
    ++met;
    const Pose reached = *forward(chain, solution->q);
    EXPECT_LT((reached.p - X.p).norm(), 1e-9);
    EXPECT_LT(angle_between(reached.R, X.R), 1e-9);
  }
  EXPECT_GT(met, 450);
}

// The turn of a joint that slides is none: a wrist of two turning joints is not the servo step's.
TEST(InverseOfPrismaticWrist, states_the_manipulability) {
  for (std::size_t slide = 3; slide < 6; ++slide) {
    DhRows rows = test::puma560().joints;
    for (DhJoint& row : rows) row.alpha_rad += 0.3;  // so that no two motions are alike
    rows[slide].type = JointType::kPrismatic;
    const Chain chain = make_chain(rows);
    const JointVector q{0.2, -0.8, 0.9, 0.3, 0.7, -0.4};
    const PoseAndJacobian at = *forward_with_jacobian(chain, q);
    const double expected =
        std::abs(at.J.leftCols<6>().determinant()) / (chain.length * chain.length);
    const auto solution = inverse(chain, at.X_0n, q);
    ASSERT_TRUE(solution.has_value());
    EXPECT_GT(expected, 0.01);
    EXPECT_NEAR(solution->regularity, expected, 1e-6 * expected) << slide;
  }
}

TEST(InverseOfAScara, meets_a_pose_that_it_can_reach) {
  const test::KnownArm arm = test::cobra600();
  const Chain chain = make_chain(arm.joints, arm.limits);
  const JointVector q{0.3, 0.5, 0.1, -0.4};
  const InverseSolution solution = *inverse(chain, *forward(chain, q), {0.25, 0.55, 0.12, -0.35});
  EXPECT_EQ(solution.verdict, Verdict::kConverged);
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
  const Chain chain = make_chain(test::puma_rows(3));
  Pose X = *forward(chain, {0.3, -0.5, 0.8});
  X.R = X.R * rotation_z(0.3);
  // The wrist point stands off the last frame; its position alone is asked for.
  const InverseSolution solution = *inverse(chain, X, {0.2, -0.4, 0.7});
  EXPECT_EQ(solution.verdict, Verdict::kConverged);
  EXPECT_LT(solution.position_error_m, 1e-9);
}

// An orientation that a short arm cannot choose is no reason to look for another posture.
TEST(InverseOfThreeJoints, gives_up_the_orientation_without_a_search) {
  const Chain chain = make_chain(test::puma_rows(3));
  const JointVector q{0.3, -0.5, 0.8};
  for (const double angle : {-0.3, -0.1, 0.1, 0.3}) {
    Pose X = *forward(chain, q);
    X.R = X.R * rotation_x(angle);
    const auto solution = inverse(chain, X, {0.2, -0.4, 0.7});
    ASSERT_TRUE(solution.has_value());
    EXPECT_EQ(solution->verdict, Verdict::kConverged);
    EXPECT_LE(solution->iterations, 40) << angle;
  }
}

// Near a fold the orientation that is given up still pulls the position away, more than Newton's
// last steps on it could make good.
TEST(InverseOfFewJoints, says_of_no_position_beside_the_seed_that_it_is_out_of_reach) {
  std::mt19937_64 random(11);
  for (const std::size_t joints : {2U, 3U, 4U, 5U}) {
    const Chain chain = make_chain(test::puma_rows(joints));
    for (int trial = 0; trial < 1'500; ++trial) {
      JointVector q;
      JointVector seed;
      for (std::size_t i = 0; i < joints; ++i) {
        q.push_back(test::uniform(random, -3, 3));
        seed.push_back(q[i] + test::uniform(random, -0.1, 0.1));
      }
      Pose X = *forward(chain, q);
      X.R = X.R * rotation_about(Vector3::UnitX(), test::uniform(random, -0.5, 0.5));
      const auto solution = inverse(chain, X, seed);
      ASSERT_TRUE(solution.has_value());
      EXPECT_NE(solution->verdict, Verdict::kOutOfReach)
          << joints << " joints, off by " << solution->position_error_m << " m";
    }
  }
}

TEST(InverseOfThreeJoints, meets_the_position_of_the_point_that_it_is_asked_for) {
  const Chain chain = make_chain(test::puma_rows(3));
  Pose X = *forward(chain, {0.3, -0.5, 0.8});
  X.R = X.R * rotation_z(0.05);
  const InverseOptions at_tool{.p_nP = {0.02, 0.1, 0.3}};
  const InverseSolution solution = *inverse(chain, X, {0.2, -0.4, 0.7}, at_tool);
  EXPECT_EQ(solution.verdict, Verdict::kConverged);
  EXPECT_LT((*forward(chain, solution.q) * at_tool.p_nP - X * at_tool.p_nP).norm(), 1e-9);
  EXPECT_GT(solution.rotation_error_rad, 0.01);
}

// Axes 1 and 2 coincide: what one turns the other may turn back, by any amount. Readings of 1e16
// rad have no angle left, and the error stated there is not the true one.
TEST(InverseOfThreeJoints, does_not_turn_axes_that_coincide_against_each_other) {
  const DhRows rows{
      {JointType::kRevolute, -2.8844989684825153, 0.43398548972378514, 0, 0},
      {JointType::kRevolute, kPi / 2, -0.16513267219528094, 0, kPi},
      {JointType::kRevolute, -kPi / 2, -0.30777518022860334, 0, -0.50463783448886756}};
  Pose X;
  X.R << -0.27048551952643912, -0.90510922899682589, -0.32804705045356447, 0.6995190399424478,
      0.049339681373474886, -0.71290862570175162, 0.66144591349898629, -0.4223066177870472,
      0.61979546956133569;
  X.p = {1.674408659315195, -0.42090041716697923, 0.47203227337621234};
  const InverseOptions options{.max_iterations = 60};
  const auto solution = inverse(
      make_chain(rows), X, {1.1741123563393583, 2.9496236962132256, 0.86414818563965845}, options);
  ASSERT_TRUE(solution);
  for (const double reading : solution->q) EXPECT_LT(std::abs(reading), 20);
  const Pose reached = *forward(make_chain(rows), solution->q);
  EXPECT_NEAR(solution->rotation_error_rad, angle_between(reached.R, X.R), 1e-9);
}

TEST(InverseOfOneJoint, turns_as_near_as_it_can) {
  DhRows rows{{JointType::kRevolute, 0, 0, 0.5, 0}};
  const Chain chain = make_chain(rows);
  const InverseSolution solution = *inverse(chain, *forward(chain, {0.7}), {0.1});
  EXPECT_EQ(solution.verdict, Verdict::kConverged);
  EXPECT_NEAR(solution.q[0], 0.7, 1e-9);
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
