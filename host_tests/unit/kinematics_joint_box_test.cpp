// SPDX-License-Identifier: MIT
// What the readings of a solution are confined to: limits and steps of each joint, its own.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/kinematics/joint_box.hpp"
#include "host_tests/support/known_arms.hpp"
#include "host_tests/support/not_finite.hpp"

namespace armsig::kinematics {
namespace {

using test::kInfinity;
constexpr Eigen::Index kJoints = 3;

// Three joints with limits and steps that no other has.
Chain limited_chain() {
  DhRows rows = test::puma560().joints;
  rows.resize(kJoints);
  return make_chain(rows, {{-1, 2}, {-3, 4}, {-5, 6}});
}
InverseOptions stepping(const JointVector& steps) {
  InverseOptions options;
  options.max_step = steps;
  return options;
}

TEST(JointBox, is_what_the_limits_leave_of_the_step_of_each_joint) {
  const JointBox box = joint_box(limited_chain(), {1.75, -2.5, 0.5}, stepping({0.5, 1, 2}));
  const double lower[] = {1.25, -3, -1.5};
  const double upper[] = {2, -1.5, 2.5};
  const bool lower_is_step[] = {true, false, true};
  const bool upper_is_step[] = {false, true, true};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    EXPECT_EQ(box.lower[k], lower[i]) << i;
    EXPECT_EQ(box.upper[k], upper[i]) << i;
    EXPECT_EQ(box.lower_is_step[i], lower_is_step[i]) << i;
    EXPECT_EQ(box.upper_is_step[i], upper_is_step[i]) << i;
  }
}

TEST(JointBox, has_the_limits_alone_without_steps_and_no_bound_without_either) {
  const JointBox limits = joint_box(limited_chain(), {0, 0, 0}, {});
  EXPECT_EQ(limits.lower[2], -5);
  EXPECT_EQ(limits.upper[1], 4);
  EXPECT_FALSE(limits.lower_is_step[2] || limits.upper_is_step[1]);
  InverseOptions anywhere;
  anywhere.respect_limits = false;
  const JointBox none = joint_box(limited_chain(), {0, 0, 0}, anywhere);
  for (Eigen::Index k = 0; k < kJoints; ++k) {
    EXPECT_EQ(none.lower[k], -kInfinity);
    EXPECT_EQ(none.upper[k], kInfinity);
  }
}

TEST(JointBox, of_a_seed_beyond_a_limit_is_one_step_towards_it) {
  const JointBox box = joint_box(limited_chain(), {3, -4, 0}, stepping({0.5, 0.25, 1}));
  EXPECT_EQ(box.lower[0], 2.5);
  EXPECT_EQ(box.upper[0], 2.5);
  EXPECT_EQ(box.lower[1], -3.75);
  EXPECT_EQ(box.upper[1], -3.75);
  EXPECT_EQ(box.lower[2], -1);
  EXPECT_EQ(box.upper[2], 1);
}

// Who commands the drive compares the difference with the step again.
TEST(JointBox, is_not_an_ulp_wider_than_the_step) {
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int k = 0; k < 1000; ++k) {
    const JointVector seed{any(generator), any(generator), any(generator)};
    const JointVector steps{0.01 * (1 + any(generator)), 0.3, 1e-4};
    InverseOptions options = stepping(steps);
    options.respect_limits = false;
    const JointBox box = joint_box(limited_chain(), seed, options);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto j = static_cast<Eigen::Index>(i);
      ASSERT_LE(seed[i] - box.lower[j], steps[i]);
      ASSERT_LE(box.upper[j] - seed[i], steps[i]);
      ASSERT_NEAR(seed[i] - box.lower[j], steps[i], 1e-15);
      ASSERT_NEAR(box.upper[j] - seed[i], steps[i], 1e-15);
    }
  }
}

}  // namespace
}  // namespace armsig::kinematics
