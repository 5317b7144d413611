// SPDX-License-Identifier: MIT
// What a chain is prepared with for the solvers.

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "core/kinematics/chain.hpp"
#include "host_tests/support/not_finite.hpp"

namespace armsig::kinematics {
namespace {

using test::kInfinity;

// The links by hand: frame 1 slides by 0.2 along axis 1, which leaves (0.3, 0.2 sin 30 deg,
// 0.2 (1 - cos 30 deg)), and frame 2 stands (0.4, 0, 0.1 + 0.2) from it.
TEST(Chain, takes_two_fifths_of_the_stretched_arm_for_its_unit_of_length) {
  const DhRows rows{{JointType::kRevolute, 0, 0.2, 0.3, radians(30)},
                    {JointType::kRevolute, 0, 0.1, 0.4, 0}};
  EXPECT_NEAR(make_chain(rows).length, 0.4 * (0.3173609 + 0.5), 1e-7);
}

TEST(Chain, counts_what_a_slide_can_lengthen_the_arm_by) {
  const DhRows rows{{JointType::kRevolute, 0, 0.1, 0, 0}, {JointType::kPrismatic, 0, 0.2, 0, 0}};
  const auto length = [&](const JointLimits& slide) {
    return make_chain(rows, {{-1, 1}, slide}).length;
  };
  EXPECT_NEAR(length({-0.2, 0.5}), 0.4 * (0.1 + 0.2 + 0.5), 1e-15);
  EXPECT_NEAR(length({-0.5, 0.2}), 0.4 * (0.1 + 0.2 + 0.5), 1e-15);
  EXPECT_NEAR(length({-kInfinity, kInfinity}), 0.4 * (0.1 + 0.2), 1e-15);
  EXPECT_NEAR(make_chain(rows).length, 0.4 * (0.1 + 0.2), 1e-15);
}

TEST(Chain, of_an_arm_without_any_length_has_the_metre_for_its_unit) {
  EXPECT_EQ(make_chain(DhRows{{JointType::kRevolute, 0, 0, 0, 0}}).length, 1);
}

}  // namespace
}  // namespace armsig::kinematics
