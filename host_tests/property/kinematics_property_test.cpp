// SPDX-License-Identifier: MIT
// A share of what armsig_many_poses tries (host_tests/benchmarks).
#include <random>

#include <gtest/gtest.h>

#include "host_tests/support/inverse_trials.hpp"
#include "host_tests/support/pose_trials.hpp"

namespace armsig::kinematics {
namespace {

TEST(InverseProperty, meets_every_pose_of_every_six_joint_arm_from_half_a_degree_away) {
  std::mt19937_64 random(1);
  for (const test::KnownArm& arm : test::six_joint_arms()) {
    EXPECT_EQ(test::missed_poses(arm, 12500, random), 0) << arm.name;
  }
}

TEST(InverseProperty, is_finite_bounded_and_truthful_about_singularities) {
  std::mt19937_64 random(2);
  for (const test::KnownArm& arm : test::six_joint_arms()) {
    test::SingularTrial trial;
    test::try_singular_poses(arm, 1000, random, trial);
    EXPECT_EQ(trial.poses, 1000) << arm.name;
    EXPECT_EQ(trial.without_verdict, 0) << arm.name;
    EXPECT_EQ(trial.not_finite, 0) << arm.name;
    EXPECT_EQ(trial.step_exceeded, 0) << arm.name;
    EXPECT_EQ(trial.iterations_exceeded, 0) << arm.name;
    EXPECT_EQ(trial.untrue, 0) << arm.name;
  }
}

TEST(InverseProperty, of_any_arm_is_not_contradicted_by_a_product_of_matrices) {
  std::mt19937_64 random(4);
  const test::InverseTrial trial = test::try_inverses(100'000, random);
  EXPECT_GE(trial.beyond_quarter_turn, trial.tried / 2);
  EXPECT_EQ(trial.refused, 0);
  EXPECT_EQ(trial.not_finite, 0);
  EXPECT_EQ(trial.outside, 0);
  EXPECT_EQ(trial.overrun, 0);
  EXPECT_EQ(trial.misstated, 0);
  EXPECT_EQ(trial.false_met, 0);
  EXPECT_EQ(trial.false_stuck, 0);
  for (const long count : trial.verdicts) EXPECT_GT(count, 0);
}

TEST(ColdStartProperty, of_calibrated_ur_arms_holds_a_solution_and_the_one_near_the_seed) {
  std::mt19937_64 random(3);
  for (const test::KnownArm& arm : {test::ur10e_individual_a(), test::ur10e_individual_b()}) {
    const test::ColdStartTrial trial = test::try_cold_starts(arm, 1000, random);
    EXPECT_EQ(trial.none, 0) << arm.name;
    EXPECT_EQ(trial.not_near, 0) << arm.name;
  }
}

}  // namespace
}  // namespace armsig::kinematics
