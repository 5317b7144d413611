// SPDX-License-Identifier: MIT
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/kinematics/cold_start.hpp"
#include "host_tests/support/kinematics_arms.hpp"
#include "host_tests/support/kinematics_random.hpp"
#include "host_tests/support/kinematics_reference.hpp"

namespace armsig::kinematics {
namespace {

constexpr int kPoses = 100000;  // over all arms
constexpr double kGoal = 1e-9;  // m and rad

bool met(const InverseSolution& solution) {
  return solution.verdict == Verdict::kConverged || solution.verdict == Verdict::kDegraded;
}

// The pose by the product of matrices in extended precision, so that the kernel under test does not
// judge itself.
Pose reference(const test::KnownArm& arm, const JointVector& q) {
  const test::Matrix4L T = test::reference_pose(arm.rows, q);
  Pose X;
  for (std::size_t r = 0; r < 3; ++r) {
    const auto row = static_cast<Eigen::Index>(r);
    X.p[row] = static_cast<double>(T[r][3]);
    for (std::size_t c = 0; c < 3; ++c) {
      X.R(row, static_cast<Eigen::Index>(c)) = static_cast<double>(T[r][c]);
    }
  }
  return X;
}

TEST(InverseProperty, meets_every_pose_of_every_six_joint_arm_from_half_a_degree_away) {
  std::mt19937_64 random(1);
  for (const test::KnownArm& arm : test::six_joint_arms()) {
    const Chain chain = make_chain(arm.rows, arm.limits);
    int missed = 0;
    for (int k = 0; k < kPoses / 8; ++k) {
      const JointVector q = test::random_readings(arm, random);
      const Pose X = reference(arm, q);
      const InverseSolution s = *inverse(chain, X, test::disturbed(arm, q, radians(0.5), random));
      const Pose found = reference(arm, s.q);
      if (!met(s) || (found.p - X.p).norm() > kGoal || angle_between(found.R, X.R) > kGoal) {
        ++missed;
      }
    }
    EXPECT_EQ(missed, 0) << arm.name;
  }
}

// A twist of the singular posture by an angle from 1e-9 to 1e-2 rad.
double near_zero(std::mt19937_64& random) {
  return std::pow(10, test::uniform(random, -9, -2)) * (random() % 2 == 0 ? 1 : -1);
}

// Limits of a tick, and a target anywhere about a singular posture, on the boundary of reach or
// beyond: finite, within the step, and a true verdict.
void expect_bounded(const test::KnownArm& arm, const JointVector& seed, const Pose& X) {
  const Chain chain = make_chain(arm.rows, arm.limits);
  InverseOptions options;
  options.max_step = JointVector(6, 0.01);
  const InverseSolution s = *inverse(chain, X, seed, options);
  for (std::size_t i = 0; i < 6; ++i) {
    ASSERT_TRUE(std::isfinite(s.q[i]));
    ASSERT_LE(std::abs(s.q[i] - seed[i]), 0.01);
  }
  ASSERT_TRUE(std::isfinite(s.position_error_m) && std::isfinite(s.rotation_error_rad));
  ASSERT_LE(s.iterations, options.max_iterations);
  const Pose found = reference(arm, s.q);
  ASSERT_NEAR((found.p - X.p).norm(), s.position_error_m, 1e-12);
  if (met(s)) {
    ASSERT_LT((found.p - X.p).norm(), kGoal);
    ASSERT_LT(angle_between(found.R, X.R), kGoal);
  }
}

TEST(InverseProperty, is_finite_bounded_and_truthful_about_singularities) {
  std::mt19937_64 random(2);
  const test::KnownArm arms[] = {test::puma560(), test::puma560_stone1986_robot2(), test::ur5(),
                                 test::ur10e_individual_b()};
  for (const test::KnownArm& arm : arms) {
    const ClosedForm form = closed_form(make_chain(arm.rows));
    for (int k = 0; k < 2000; ++k) {
      JointVector seed = test::random_readings(arm, random);
      if (k % 4 == 0) seed[4] = near_zero(random);                   // wrist straight
      if (k % 4 == 1) seed[2] = -form.theta[2] + near_zero(random);  // elbow of the UR stretched
      if (k % 4 == 2) seed[2] = kPi / 2 + near_zero(random);         // elbow of the Puma, nearly
      JointVector goal = seed;
      for (double& reading : goal) reading += test::uniform(random, -0.02, 0.02);
      Pose X = reference(arm, goal);
      if (k % 3 == 1) X.p *= test::uniform(random, 0.98, 1.02);
      if (k % 3 == 2) X.p *= test::uniform(random, 0.0, 3.0);
      expect_bounded(arm, seed, X);
    }
  }
}

TEST(ColdStartProperty, of_calibrated_ur_arms_holds_a_solution_and_the_one_near_the_seed) {
  std::mt19937_64 random(3);
  for (const test::KnownArm& arm : {test::ur10e_individual_a(), test::ur10e_individual_b()}) {
    const Chain chain = make_chain(arm.rows, arm.limits);
    const ClosedForm form = closed_form(chain);
    for (int k = 0; k < 1000; ++k) {
      const JointVector q = test::random_readings(arm, random);
      const JointVector seed = test::disturbed(arm, q, radians(0.5), random);
      const Pose X = *forward(chain, q);
      ASSERT_FALSE(cold_start(chain, form, X)->empty());
      const Solutions solutions = *cold_start(chain, form, X, seed);
      ASSERT_FALSE(solutions.empty());
      double farthest = 0;
      for (std::size_t i = 0; i < 6; ++i) {
        farthest = std::max(farthest, std::abs(solutions[0].solution.q[i] - seed[i]));
      }
      // Next to a singularity the nearest solution may be a little further than the true one.
      EXPECT_LT(farthest, 0.1);
    }
  }
}

}  // namespace
}  // namespace armsig::kinematics
