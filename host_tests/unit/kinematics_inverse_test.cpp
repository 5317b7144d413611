// SPDX-License-Identifier: MIT
#include <cmath>
#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/kinematics/inverse.hpp"
#include "host_tests/support/kinematics_random.hpp"
#include "host_tests/support/known_arms.hpp"
#include "host_tests/support/ready_puma.hpp"

namespace armsig::kinematics {
namespace {

using test::kReady;
using test::puma_chain;

TEST(Inverse, finds_the_readings_that_made_the_pose) {
  JointVector seed = kReady;
  for (double& reading : seed) reading += radians(0.5);
  const InverseSolution solution = *inverse(puma_chain(), *forward(puma_chain(), kReady), seed);
  EXPECT_EQ(solution.verdict, Verdict::kConverged);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(solution.q[i], kReady[i], 1e-9);
  EXPECT_LE(solution.iterations, 4);
}

TEST(Inverse, says_that_a_pose_is_out_of_reach_and_comes_as_near_as_it_can) {
  Pose X = *forward(puma_chain(), kReady);
  X.p = X.p.normalized() * 1.5;
  const InverseSolution solution = *inverse(make_chain(test::puma560().joints), X, kReady);
  EXPECT_EQ(solution.verdict, Verdict::kOutOfReach);
  // The wrist of the Puma is at most |(0.4318 + 0.4312, 0.14909)| from its base.
  EXPECT_NEAR(solution.position_error_m, 1.5 - 0.8758, 2e-3);
}

TEST(Inverse, says_that_a_joint_limit_is_in_the_way_and_stays_inside) {
  const test::KnownArm arm = test::puma560();
  const Chain chain = puma_chain();
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
  const InverseSolution solution =
      *inverse(puma_chain(), *forward(puma_chain(), beyond), kReady, options);
  EXPECT_EQ(solution.verdict, Verdict::kConverged);
}

TEST(Inverse, says_that_the_step_is_limited_and_goes_no_further) {
  JointVector goal = kReady;
  goal[0] += 0.1;
  InverseOptions options;
  options.max_step = JointVector(6, 0.02);
  const InverseSolution solution =
      *inverse(puma_chain(), *forward(puma_chain(), goal), kReady, options);
  EXPECT_EQ(solution.verdict, Verdict::kStepLimit);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_LE(std::abs(solution.q[i] - kReady[i]), 0.02);
}

// Also where readings are alike, or one moves to where its neighbour stands.
TEST(Inverse, keeps_each_joint_to_its_own_step) {
  for (std::size_t slow = 0; slow < 6; ++slow) {
    JointVector neighbour(6, 0.3);
    neighbour[slow == 0 ? 1 : slow - 1] += 0.1;
    for (const JointVector& seed : {kReady, JointVector(6, 0.3), neighbour}) {
      JointVector goal = seed;
      goal[slow] += 0.1;
      InverseOptions options;
      options.max_step = JointVector(6, 1.0);
      options.max_step[slow] = 0.02;
      const InverseSolution limited =
          *inverse(puma_chain(), *forward(puma_chain(), goal), seed, options);
      EXPECT_LE(std::abs(limited.q[slow] - seed[slow]), 0.02) << slow;
      options.max_step = JointVector(6, 1e-3);
      options.max_step[slow] = 0.2;
      const InverseSolution reached =
          *inverse(puma_chain(), *forward(puma_chain(), goal), seed, options);
      EXPECT_EQ(reached.verdict, Verdict::kConverged) << slow;
    }
  }
}

TEST(Inverse, moves_a_seed_outside_the_limits_towards_them_by_no_more_than_a_step) {
  JointVector seed = kReady;
  seed[0] = test::puma560().limits[0].upper + 0.5;
  InverseOptions options;
  options.max_step = JointVector(6, 0.02);
  const InverseSolution solution =
      *inverse(puma_chain(), *forward(puma_chain(), kReady), seed, options);
  EXPECT_NEAR(solution.q[0], seed[0] - 0.02, 1e-12);
}

TEST(Inverse, is_degraded_where_the_wrist_is_straight) {
  JointVector q = kReady;
  q[4] = 1e-9;
  JointVector seed = q;
  for (double& reading : seed) reading += 0.003;
  const InverseSolution solution = *inverse(puma_chain(), *forward(puma_chain(), q), seed);
  EXPECT_EQ(solution.verdict, Verdict::kDegraded);
  EXPECT_LT(solution.position_error_m, 1e-9);
  EXPECT_LT(solution.rotation_error_rad, 1e-9);
}

TEST(Inverse, stops_at_the_iterations_it_was_given) {
  JointVector seed = kReady;
  seed[1] -= 1.0;
  seed[3] += 1.0;
  const InverseOptions options{.max_iterations = 3};
  const InverseSolution solution =
      *inverse(puma_chain(), *forward(puma_chain(), kReady), seed, options);
  EXPECT_EQ(solution.verdict, Verdict::kNotConverged);
  EXPECT_LE(solution.iterations, 3);
}

TEST(Inverse, counts_every_pass_of_every_loop) {
  JointVector seed = kReady;
  for (double& reading : seed) reading += radians(2);
  Pose unreachable = *forward(puma_chain(), kReady);
  unreachable.p *= 1.5;
  for (const Pose& X : {*forward(puma_chain(), kReady), unreachable}) {
    for (int most = 1; most < 30; ++most) {
      const InverseOptions options{.max_iterations = most};
      const auto solution = inverse(puma_chain(), X, seed, options);
      ASSERT_TRUE(solution.has_value());
      EXPECT_LE(solution->iterations, most);
      EXPECT_GE(solution->iterations, 1);
    }
  }
  const InverseOptions once{.max_iterations = 1};
  EXPECT_EQ(inverse(puma_chain(), *forward(puma_chain(), seed), seed, once)->verdict,
            Verdict::kConverged);
}

// The same measure by both ways: that of the servo's steps, and that of the damped descent.
TEST(Inverse, states_the_manipulability_whatever_the_solver) {
  std::mt19937_64 random(8);
  for (const test::KnownArm& arm : test::six_joint_arms()) {
    const Chain chain = make_chain(arm.joints);
    for (int k = 0; k < 40; ++k) {
      const JointVector q = test::random_readings(arm, random);
      const Pose X = *forward(chain, q);
      const auto near = inverse(chain, X, test::disturbed(arm, q, radians(0.5), random));
      ASSERT_TRUE(near.has_value());
      const PoseAndJacobian at = *forward_with_jacobian(chain, near->q);
      double expected = std::abs(at.J.leftCols<6>().determinant()) / std::pow(chain.length, 3);
      for (const DhJoint& row : arm.joints) {
        if (row.type == JointType::kPrismatic) expected *= chain.length;
      }
      EXPECT_NEAR(near->regularity, expected, 0.01 * expected + 1e-6) << arm.name;
      // A single pass is left to the damped solver.
      const InverseOptions damped{.p_nP = {0.1, 0.2, 0.3}, .max_iterations = 1};
      EXPECT_NEAR(inverse(chain, X, near->q, damped)->regularity, expected, 1e-6 * expected + 1e-6)
          << arm.name;
    }
  }
}

}  // namespace
}  // namespace armsig::kinematics
