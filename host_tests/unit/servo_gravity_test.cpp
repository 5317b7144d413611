// SPDX-License-Identifier: MIT
// What gravity does to the joints in the servo tick, and the lever that bounds it.
#include "firmware/calibration/servo_gravity.hpp"

#include <gtest/gtest.h>

#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
namespace {

using test::kP;
using test::kR;

ServoGravity gravity_of(const Arm& drawing, const std::vector<GravityTerm>& terms) {
  PackedDeflections deflections = packed(model_of(drawing, {}));
  for (const GravityTerm& term : terms) deflections.gravity.push_back(term);
  ServoGravity gravity;
  gravity.set(deflections, drawing);
  return gravity;
}

TEST(ServoGravity, has_the_links_laid_end_to_end_as_its_longest_lever) {
  const Arm arm =
      test::make_arm({{kR, 0, 0.4, 0.3, kPi / 2}, {kP, 0.1, 0.12, 0.05, 0}, {kR, 0, 0, 0.25, 0}},
                     {{-3, 3}, {-0.2, 0.7}, {-3, 3}});
  EXPECT_NEAR(gravity_of(arm, {}).lever_m(), 0.5 + 0.13 + 0.7 + 0.25, 1e-15);
  Arm pulled = arm;
  pulled.limits[1] = {-0.9, 0.1};
  EXPECT_NEAR(gravity_of(pulled, {}).lever_m(), 0.5 + 0.13 + 0.9 + 0.25, 1e-15);
}

TEST(ServoGravity, has_no_lever_longer_than_any_arm) {
  const Arm arm = test::make_arm({{kR, 0, 0, 30, 0}, {kR, 0, 0, 30, 0}}, {{-3, 3}, {-3, 3}});
  EXPECT_EQ(gravity_of(arm, {}).lever_m(), kLongestLever_m);
}

// Axes 30 degrees off the horizontal, and then upright: gravity pulls at the first along 1/2.
TEST(ServoGravity, pulls_at_slides_along_the_vertical_wherever_they_are) {
  const Arm arm = test::make_arm(
      {{kP, 0, 0, 0, radians(60)}, {kP, 0.3, 0, 0.1, radians(-60)}, {kP, 0, 0, 0.1, 0}},
      {{-1, 1}, {-1, 1}, {-1, 1}});
  const ServoGravity gravity = gravity_of(arm, {{.joint = 1, .origin = 3, .coefficient = 1e-3},
                                                {.joint = 2, .origin = 3, .coefficient = 2e-3}});
  // Of joint 2, z by the product of the rotations, here written out for any reading.
  const double sixty = radians(60);
  const double z =
      std::cos(sixty) * std::cos(sixty) + std::sin(sixty) * std::cos(0.3) * std::sin(sixty);
  for (const double reading : {-0.8, 0.0, 0.5}) {
    ServoGravity::Values q{};
    q.fill(reading);
    ServoGravity::Values by;
    gravity.at(q, by);
    EXPECT_EQ(by[0], 0);
    EXPECT_NEAR(by[1], -1e-3 * std::cos(sixty), 1e-15) << reading;
    EXPECT_NEAR(by[2], -2e-3 * z, 1e-15) << reading;
  }
}

}  // namespace
}  // namespace armsig::calibration
