// SPDX-License-Identifier: MIT
// From joint axes in space to the Denavit-Hartenberg rows of an arm description.
#pragma once

#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "firmware/formats/arm_file.hpp"

namespace armsig::tool {

// One joint at reading zero, in the base: a point on its axis and its direction.
struct ChainAxis {
  JointType type = JointType::kRevolute;
  JointLimits limits;
  Vector3 point_B = Vector3::Zero();
  Vector3 direction_B = Vector3::UnitZ();
};

struct AxisChain {
  FixedVector<ChainAxis, kMaxJoints> axes;  // at least one
  FixedVector<JointCoupling, kMaxJoints> couplings;
  Pose X_BT;  // the tip, at readings zero
};

// Neighbouring axes closer to parallel than this are meant parallel: files round pi / 2 to 1.5708
// at worst, and one turn of 1.57 and back leaves less.
inline constexpr double kMeantParallel_rad = 1e-5;

struct DrawnChain {
  Arm arm;
  Pose X_B0;  // Denavit-Hartenberg frame 0 in the base
  Pose X_FT;  // the tip in Denavit-Hartenberg frame n
  // What was changed, and what an arm description does not hold, in words.
  std::vector<std::string> notes;
};

// Standard Denavit-Hartenberg rows with the smallest offsets. Frame 0 is the base where its z axis
// is that of joint 1, frame n the tip where its z axis and place allow.
[[nodiscard]] DrawnChain drawn(const AxisChain& chain);

}  // namespace armsig::tool
