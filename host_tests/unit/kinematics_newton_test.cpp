// SPDX-License-Identifier: MIT
// The servo tick's way to the answer, and where it leaves it to the damped one.
#include <cmath>
#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/kinematics/newton.hpp"
#include "core/kinematics/verdict.hpp"
#include "host_tests/support/kinematics_random.hpp"
#include "host_tests/support/known_arms.hpp"
#include "host_tests/support/ready_puma.hpp"

namespace armsig::kinematics {
namespace {

using test::kReady;
using test::puma_chain;

// What an answer says of its own error is what another computation finds.
TEST(Newton, states_the_error_that_it_leaves) {
  JointVector seed = kReady;
  seed[0] += 4e-4;
  seed[4] -= 3e-4;
  const Pose X = *forward(puma_chain(), kReady);
  const InverseOptions loose{.position_tolerance_m = 1e-3, .rotation_tolerance_rad = 1e-3};
  int passes = 0;
  const auto solution = newton_inverse(puma_chain(), X, seed, loose, passes);
  ASSERT_TRUE(solution.has_value());
  EXPECT_EQ(passes, 1);
  const Pose reached = *forward(puma_chain(), solution->q);
  EXPECT_GT(solution->rotation_error_rad, 1e-4);
  EXPECT_NEAR(solution->rotation_error_rad, angle_between(reached.R, X.R), 1e-12);
  EXPECT_NEAR(solution->position_error_m, (reached.p - X.p).norm(), 1e-15);
}

TEST(Newton, takes_all_passes_but_the_one_that_it_leaves) {
  const Pose X = *forward(puma_chain(), kReady);
  JointVector seed = kReady;
  for (double& reading : seed) reading += radians(0.5);
  int needed = 0;
  ASSERT_TRUE(newton_inverse(puma_chain(), X, seed, {}, needed));
  for (int most = 1; most <= needed + 1; ++most) {
    int passes = 0;
    const auto solution = newton_inverse(puma_chain(), X, seed, {.max_iterations = most}, passes);
    EXPECT_EQ(solution.has_value(), most > needed) << most;
    EXPECT_LT(passes, most);
  }
}

double relative_volume(const Matrix3& columns) {
  return std::abs(columns.determinant()) /
         (columns.col(0).norm() * columns.col(1).norm() * columns.col(2).norm());
}

// The axes of the wrist span |sin q5|.
TEST(Newton, leaves_a_wrist_within_a_hundredth_of_straight_to_the_damped_way) {
  for (const double bend : {0.0099, -0.0099, 0.0101, -0.0101}) {
    JointVector q = kReady;
    q[4] = std::asin(bend);
    int passes = 0;
    const auto solution = newton_inverse(puma_chain(), *forward(puma_chain(), q), q, {}, passes);
    EXPECT_EQ(solution.has_value(), std::abs(bend) > 0.01) << bend;
  }
}

// What the first three joints move the wrist by, while it holds the tool's orientation.
TEST(Newton, leaves_an_arm_within_a_hundredth_of_stretched_to_the_damped_way) {
  int answered = 0;
  int left = 0;
  for (double elbow = -kPi; elbow < kPi; elbow += 0.001) {
    JointVector q = kReady;
    q[2] = elbow;
    const PoseAndJacobian at = *forward_with_jacobian(puma_chain(), q);
    const Matrix3 A = at.J.topLeftCorner<3, 3>();
    const Matrix3 B = at.J.block<3, 3>(0, 3);
    const Matrix3 C = at.J.bottomLeftCorner<3, 3>();
    const Matrix3 D = at.J.block<3, 3>(3, 3);
    const double volume = relative_volume(A - B * D.inverse() * C);
    if (std::abs(volume - 0.01) < 1e-4) continue;
    int passes = 0;
    const auto solution = newton_inverse(puma_chain(), at.X_0n, q, {.degraded_below = 0}, passes);
    ASSERT_EQ(solution.has_value(), volume > 0.01) << elbow;
    ++(solution ? answered : left);
  }
  EXPECT_GT(answered, 1000);
  EXPECT_GT(left, 10);
}

}  // namespace
}  // namespace armsig::kinematics
