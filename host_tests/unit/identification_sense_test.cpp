// SPDX-License-Identifier: MIT
// A stage of slides and one turn is identified whichever way round it was drawn, and says so.
#include <gtest/gtest.h>

#include "core/identification.hpp"

namespace armsig {
namespace {

features::JointFeature along(JointType type, const Vector3& axis_S) {
  features::JointFeature feature;
  feature.type = type;
  feature.axis_S = axis_S;
  feature.radial_S = any_perpendicular(axis_S);
  feature.radius_m = type == JointType::kRevolute ? 0.1 : 0.0;
  return feature;
}

TEST(Identify, flags_but_accepts_a_stage_whose_only_turn_is_drawn_the_other_way_round) {
  Arm drawing;
  drawing.joints.push_back({.type = JointType::kPrismatic});
  drawing.joints.push_back({.type = JointType::kRevolute, .alpha_rad = radians(-90)});
  drawing.joints.push_back({.type = JointType::kPrismatic});
  const auto signature = identify({along(JointType::kPrismatic, Vector3(0, 0, 1)),
                                   along(JointType::kRevolute, Vector3(0, 0, -1)),
                                   along(JointType::kPrismatic, Vector3(0, 1, 0))},
                                  {0, 0, 0}, drawing);
  ASSERT_TRUE(signature);
  EXPECT_FALSE(signature->description_matches);
}

}  // namespace
}  // namespace armsig
