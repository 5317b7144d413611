// SPDX-License-Identifier: MIT
// What the inverse refuses to answer.
#include <optional>

#include <gtest/gtest.h>

#include "core/kinematics/inverse.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/not_finite.hpp"
#include "host_tests/support/ready_puma.hpp"

namespace armsig::kinematics {
namespace {

using test::kInfinity;
using test::kNan;
using test::kReady;
using test::puma_chain;

TEST(Inverse, refuses_a_pose_or_a_seed_that_is_not_finite) {
  Pose X = *forward(puma_chain(), kReady);
  X.p.y() = kNan;
  EXPECT_EQ(test::failure_of(inverse(puma_chain(), X, kReady)), Error::kNotFinite);
  X = *forward(puma_chain(), kReady);
  X.R(2, 1) = kNan;
  EXPECT_EQ(test::failure_of(inverse(puma_chain(), X, kReady)), Error::kNotFinite);
  JointVector seed = kReady;
  seed[3] = kNan;
  EXPECT_EQ(test::failure_of(inverse(puma_chain(), *forward(puma_chain(), kReady), seed)),
            Error::kNotFinite);
}

TEST(Inverse, refuses_a_target_that_is_not_a_rotation) {
  const Pose X = *forward(puma_chain(), kReady);
  const Chain three = make_chain(test::puma_rows(3));
  Matrix3 mirrored = X.R;
  mirrored.col(2) *= -1;
  Matrix3 skewed = X.R;
  skewed.col(1) += 1e-6 * X.R.col(0);
  for (const Matrix3& R : {Matrix3(Matrix3::Zero()), Matrix3(2 * X.R), mirrored, skewed,
                           Matrix3(-X.R), Matrix3(X.R * (1 + 1e-6))}) {
    const Pose target{R, X.p};
    const auto six = inverse(puma_chain(), target, kReady);
    ASSERT_FALSE(six.has_value());
    EXPECT_EQ(test::failure_of(six), Error::kNotARotation);
    const auto few = inverse(three, target, {0.2, -0.8, 0.9});
    ASSERT_FALSE(few.has_value());
    EXPECT_EQ(test::failure_of(few), Error::kNotARotation);
  }
}

TEST(Inverse, refuses_options_that_are_no_numbers_or_out_of_range) {
  const Pose X = *forward(puma_chain(), kReady);
  const auto error_of = [&](const InverseOptions& options) {
    JointVector seed = kReady;
    seed[1] += 1.5;  // beyond the reach of Newton
    const auto solution = inverse(puma_chain(), X, seed, options);
    return solution ? std::optional<Error>() : solution.error();
  };
  EXPECT_EQ(error_of({.p_nP = {0, kNan, 0}}), Error::kNotFinite);
  EXPECT_EQ(test::failure_of(inverse(puma_chain(), X, kReady, {.p_nP = {0, kNan, 0}})),
            Error::kNotFinite);
  EXPECT_EQ(error_of({.p_nP = {0, kInfinity, 0}}), Error::kNotFinite);
  EXPECT_EQ(error_of({.position_tolerance_m = kNan}), Error::kNotFinite);
  EXPECT_EQ(error_of({.max_iterations = 0}), Error::kOutOfRange);
  InverseOptions step;
  step.max_step = JointVector(6, 0.02);
  step.max_step[3] = kNan;
  EXPECT_EQ(error_of(step), Error::kNotFinite);
  EXPECT_EQ(test::failure_of(inverse(puma_chain(), X, kReady, step)), Error::kNotFinite);
  step.max_step[3] = -0.02;
  EXPECT_EQ(error_of(step), Error::kOutOfRange);
  step.max_step = JointVector(6, kInfinity);
  EXPECT_EQ(error_of(step), std::nullopt);
}

TEST(Inverse, refuses_what_is_too_far_for_a_verdict) {
  Pose X = *forward(puma_chain(), kReady);
  X.p.x() = 1e200;
  EXPECT_EQ(test::failure_of(inverse(puma_chain(), X, kReady)), Error::kOutOfReach);
  JointVector seed = kReady;
  seed[0] = 1e200;
  EXPECT_EQ(test::failure_of(inverse(puma_chain(), *forward(puma_chain(), kReady), seed)),
            Error::kOutOfRange);
}

// What is off is off, however far from the pose an answer may be.
TEST(Inverse, refuses_what_is_no_rotation_where_the_tolerance_is_loose) {
  Pose X = *forward(puma_chain(), kReady);
  X.R = X.R * rotation_x(8e-4);
  const InverseOptions options{.rotation_tolerance_rad = 1e-3};
  EXPECT_TRUE(inverse(puma_chain(), X, kReady, options));
  X.R.col(2) *= 1 + 5e-4;
  const auto solution = inverse(puma_chain(), X, kReady, options);
  ASSERT_FALSE(solution.has_value());
  EXPECT_EQ(test::failure_of(solution), Error::kNotARotation);
}

// An axis too long by d is off by d.
TEST(Inverse, takes_for_a_rotation_what_is_off_by_a_billionth_and_no_more) {
  const DhRows slide{{JointType::kPrismatic, 0, 0, 0, 0}};
  const Chain chain = make_chain(slide);
  Pose X;
  X.R(2, 2) = 1 + 0.9e-9;
  EXPECT_TRUE(inverse(chain, X, {0.1}));
  X.R(2, 2) = 1 + 1.1e-9;
  const auto solution = inverse(chain, X, {0.1});
  ASSERT_FALSE(solution.has_value());
  EXPECT_EQ(test::failure_of(solution), Error::kNotARotation);
}

TEST(Inverse, refuses_each_option_that_is_no_number_or_below_zero) {
  Pose X = *forward(puma_chain(), kReady);
  X.p.x() += 3;  // which is not met, so that every option is looked at
  const auto refused = [&](const InverseOptions& options) {
    return test::failure_of(inverse(puma_chain(), X, kReady, options));
  };
  EXPECT_EQ(refused({.rotation_tolerance_rad = kNan}), Error::kNotFinite);
  EXPECT_EQ(refused({.degraded_below = kNan}), Error::kNotFinite);
  EXPECT_EQ(refused({.position_tolerance_m = -1e-6}), Error::kOutOfRange);
  EXPECT_EQ(refused({.rotation_tolerance_rad = -1e-6}), Error::kOutOfRange);
}

// Farther than a million metres from corner to corner, and no coordinate is.
TEST(Inverse, judges_a_pose_whose_coordinates_are_each_within_bounds) {
  Pose X = *forward(puma_chain(), kReady);
  X.p = Vector3(9e5, 9e5, 9e5);
  const auto solution = inverse(puma_chain(), X, kReady);
  ASSERT_TRUE(solution);
  EXPECT_NE(solution->verdict, Verdict::kConverged);
}

}  // namespace
}  // namespace armsig::kinematics
