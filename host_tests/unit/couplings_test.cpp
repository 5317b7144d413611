// SPDX-License-Identifier: MIT
// What couplings of joints do to an arm as a whole.
#include "core/base/couplings.hpp"

#include <gtest/gtest.h>

#include "core/base/joint_range.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig {
namespace {

TEST(Couplings, that_hang_in_a_ring_lead_back_to_each_of_it) {
  // Each turns with the one named second; joint 3 hangs on the ring without being of it.
  const JointCouplings ring{{0, 1, 1}, {1, 2, 1}, {2, 0, 1}, {3, 0, 1}};
  for (const std::size_t joint : {0, 1, 2}) EXPECT_TRUE(leads_back(ring, joint)) << joint;
  EXPECT_FALSE(leads_back(ring, 3));
}

TEST(Couplings, of_a_wrist_lead_nowhere_back) {
  const JointCouplings wrist{{4, 3, 0.5}, {5, 4, -1}, {5, 3, 0.5}};
  for (const std::size_t joint : {3, 4, 5}) EXPECT_FALSE(leads_back(wrist, joint)) << joint;
}

TEST(Couplings, widen_the_limits_of_what_is_coupled_whatever_their_sign) {
  Arm arm = test::make_arm({{test::kR, 0, 0, 0, 0}, {test::kR, 0, 0, 0, 0}}, {{-1, 2}, {-3, 3}});
  arm.couplings.push_back({1, 0, -0.5});
  const auto limits = effective_limits(arm);
  EXPECT_EQ(limits[0].lower, -1);
  EXPECT_EQ(limits[0].upper, 2);
  EXPECT_EQ(limits[1].lower, -3 - 0.5 * 2);
  EXPECT_EQ(limits[1].upper, 3 + 0.5 * 1);
}

TEST(Couplings, take_the_limits_of_what_hangs_on_a_joint_without_end) {
  Arm arm = test::make_arm({{test::kR, 0, 0, 0, 0}, {test::kR, 0, 0, 0, 0}}, {{-1, 2}, {-3, 3}});
  arm.limits[0] = kNoLimits;
  arm.couplings.push_back({1, 0, -0.5});
  EXPECT_TRUE(is_endless(effective_limits(arm)[1]));
  arm.couplings[0].ratio = 0;
  EXPECT_EQ(effective_limits(arm)[1].lower, -3);
  EXPECT_EQ(effective_limits(arm)[1].upper, 3);
}

TEST(JointRange, of_a_joint_without_end_is_one_turn_around_zero) {
  EXPECT_EQ(finite_range(kNoLimits).lower, -kPi);
  EXPECT_EQ(finite_range(kNoLimits).upper, kPi);
  EXPECT_EQ(middle_of(kNoLimits), 0);
  EXPECT_EQ(middle_of({-1, 2}), 0.5);
  EXPECT_EQ(finite_range({-9, 2}).lower, -9);
}

}  // namespace
}  // namespace armsig
