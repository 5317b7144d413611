// SPDX-License-Identifier: MIT
// Where the error is at right angles to all that the joints can do: on a fold, at half a turn.
#include <cmath>

#include <gtest/gtest.h>

#include "core/kinematics/inverse.hpp"
#include "host_tests/support/known_arms.hpp"
#include "host_tests/support/ready_puma.hpp"

namespace armsig::kinematics {
namespace {

using test::kReady;

DhRows turning_wrist() {
  DhRows wrist;
  for (const double alpha : {kPi / 2, -kPi / 2, 0.0}) {
    wrist.push_back({JointType::kRevolute, 0, 0, 0, alpha});
  }
  return wrist;
}

// Half a turn from the seed the sine of the angle is zero, as it is at the seed itself.
TEST(Inverse, turns_half_a_turn_and_never_takes_the_seed_for_it) {
  const Chain chain = make_chain(test::puma560().joints);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double angle : {kPi, kPi - 1e-12, kPi - 1e-6}) {
      Pose X = *forward(chain, kReady);
      X.R = X.R * rotation_about(Vector3::Unit(axis), angle);
      const auto solution = inverse(chain, X, kReady);
      ASSERT_TRUE(solution.has_value());
      const Pose reached = *forward(chain, solution->q);
      EXPECT_NEAR(solution->rotation_error_rad, angle_between(reached.R, X.R), 1e-12);
      EXPECT_EQ(solution->verdict, Verdict::kConverged) << axis;
      EXPECT_LT(angle_between(reached.R, X.R), 1e-9) << axis;
    }
  }
}

// With the wrist straight no joint turns about x: the pose half a turn about it is found all the
// same, by way of a bent wrist.
TEST(Inverse, leaves_a_saddle_at_half_a_turn) {
  const Chain chain = make_chain(turning_wrist());
  Pose X;
  X.R = rotation_x(kPi);
  const auto solution = inverse(chain, X, {0, 0, 0});
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(solution->rotation_error_rad, 1e-9);
}

// The same close by: a degree about x is found by turning joint 1 far.
TEST(Inverse, leaves_the_saddle_of_a_straight_wrist) {
  const Chain chain = make_chain(turning_wrist());
  for (const double angle : {0.001, 0.01, 0.029}) {
    Pose X;
    X.R = rotation_x(angle);
    const auto solution = inverse(chain, X, {0, 0, 0});
    ASSERT_TRUE(solution.has_value());
    EXPECT_LT(solution->rotation_error_rad, 1e-9) << angle;
  }
}

TEST(Inverse, leaves_the_saddle_of_a_stretched_arm) {
  const Chain chain = make_chain(
      DhRows{{JointType::kRevolute, 0, 0, 0.5, 0}, {JointType::kRevolute, 0, 0, 0.5, 0}});
  Pose X;
  X.p = {0.8, 0, 0};
  const auto solution = inverse(chain, X, {0, 0});
  ASSERT_TRUE(solution.has_value());
  EXPECT_EQ(solution->verdict, Verdict::kConverged);
  EXPECT_LT(solution->position_error_m, 1e-9);
}

// The elbow bends to the one side that its limits leave.
TEST(Inverse, leaves_a_saddle_to_either_side) {
  const DhRows links(2, {JointType::kRevolute, 0, 0, 0.5, 0});
  Pose X;
  X.p = {0.8, 0, 0};
  for (const JointLimits& elbow : {JointLimits{0, 2}, JointLimits{-2, 0}}) {
    const Chain chain = make_chain(links, {{-2, 2}, elbow});
    const auto solution = inverse(chain, X, {0, 0});
    ASSERT_TRUE(solution.has_value());
    EXPECT_EQ(solution->verdict, Verdict::kConverged);
  }
}

// Six links in a row, stretched: on the way from there no other verdict than that it ran out.
TEST(Inverse, says_that_the_iterations_ran_out_wherever_on_the_way_from_a_saddle) {
  const Chain chain = make_chain(DhRows(6, {JointType::kRevolute, 0, 0, 0.5, 0}));
  Pose X;
  X.p = {2, 0, 0};
  const JointVector seed(6, 0.0);
  const auto solution = inverse(chain, X, seed);
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(solution->position_error_m, 1e-9);
  for (int most = 1; most < solution->iterations; ++most) {
    const auto cut = inverse(chain, X, seed, {.max_iterations = most});
    ASSERT_TRUE(cut.has_value());
    EXPECT_EQ(cut->verdict, Verdict::kNotConverged) << most;
    EXPECT_EQ(cut->iterations, most);
  }
}

}  // namespace
}  // namespace armsig::kinematics
