// SPDX-License-Identifier: MIT
#include "core/calibration/packed_deflections.hpp"

#include <gtest/gtest.h>

#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
namespace {

TEST(PackedDeflections, keep_the_drawn_zero_of_each_joint) {
  const Arm arm = test::make_arm({{test::kR, 0.1, 0.4, 0.3, kPi / 2},
                                  {test::kP, 0.5, 0.12, 0.05, 0},
                                  {test::kR, -0.7, 0, 0.25, 0}},
                                 {{-3, 3}, {-0.2, 0.7}, {-3, 3}});
  const PackedDeflections deflections = packed(model_of(arm, {}));
  EXPECT_EQ(deflections.drawn_zero[0], 0.1);
  EXPECT_EQ(deflections.drawn_zero[1], 0.12);  // of a slide, a length
  EXPECT_EQ(deflections.drawn_zero[2], -0.7);
}

}  // namespace
}  // namespace armsig::calibration
