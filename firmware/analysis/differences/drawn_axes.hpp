// SPDX-License-Identifier: MIT
// The joint axes of a drawing, each with a frame of its own on the link before it, in which a
// difference can be told to a person: "towards axis 1", "away from axis 2".
//
// The frames depend on where the axes are and on nothing else: not on the rows that say so, not on
// the readings of the day, not on the frame that anything was measured in.
#pragma once

#include <cstdint>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::differences {

// What the x axis of such a frame points at. y stands upright on it and on the joint axis, z.
enum class Heading : std::uint8_t {
  kAlongAxis,     // as `other`, an axis that is not parallel; y along their common perpendicular
  kAwayFromAxis,  // from `other`, a parallel axis, to this one; y out of the plane of the two
  kToTool,        // to the tool with all joints at zero: there is no other axis to go by
};

// Of one joint, in the frame of its DrawnAxis: how its axis, on the link before, departs from the
// drawing, and its zero.
enum class Deviation : std::uint8_t { kTiltX, kTiltY, kShiftX, kShiftY, kZero };
inline constexpr std::size_t kDeviations = 5;

struct DrawnAxis {
  JointType type = JointType::kRevolute;
  // This axis in the frame of the one before it, whose joint reads zero; of the first, in the base.
  Pose X_before;
  Heading heading = Heading::kToTool;
  std::size_t other = 0;  // index of that axis
  // kAlongAxis: y points away from the other axis (+1), at it (-1), or the two meet (0).
  int y_away = 0;
  // What a zero before does just as well, and is laid to that zero: a tilt about a revolute axis
  // before, a shift along a prismatic one, a shift out of the plane of two parallel axes. kZero:
  // nothing.
  Deviation of_zero = Deviation::kZero;
};

// Of the arm `drawing` with a tool at p_nT of its last Denavit-Hartenberg frame. The origin of a
// frame is the point of its axis that is nearest to the revolute axis before; of parallel axes, the
// point nearest to the next; of none of these, to the middle of where the tool goes. Of a prismatic
// joint it is that middle. Precondition: limits for each of 1 to 8 joints.
[[nodiscard]] FixedVector<DrawnAxis, kMaxJoints> drawn_axes(const Arm& drawing,
                                                            const Vector3& p_nT);

}  // namespace armsig::differences
