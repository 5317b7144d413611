// SPDX-License-Identifier: MIT
// Did the arm change, or did the reference move: the sensor, its stand, or the arm's foot as a
// whole? What moved as one piece shifts and turns every point of the work space alike; a link that
// changed does not.
#pragma once

#include <span>

#include "core/base/error.hpp"
#include "core/base/pose.hpp"

namespace armsig::drift {

enum class Moved : std::uint8_t {
  kNothing,
  kReference,  // a rigid motion explains it, and what it leaves has no room for a change of the arm
  kArm,        // no rigid motion explains it
  kUndecided,  // something moved; the poses or the checks are too few to say what
};
[[nodiscard]] std::string_view describe(Moved moved);

struct PoseResidual {
  Vector3 p_R = Vector3::Zero();         // the tool at the pose, by the model, in the sensor frame
  Vector3 residual_m = Vector3::Zero();  // measured less that; the mean over the checks looked at
};

struct ReferenceReport {
  Moved moved = Moved::kNothing;
  Vector3 shift_m = Vector3::Zero();   // of the rigid motion, at the mean of the poses
  Vector3 turn_rad = Vector3::Zero();  // its rotation vector
  double explained = 0;                // by it, of the sum of squares in units of sigma
  double left = 0;                     // what it leaves: chi-square of 3 n - 6 degrees
};

// `sigma_m` is one sigma of a component of each residual. A change of the first joint's zero is a
// turn of the whole arm about one line, and no residual tells it from a turned foot. Errors:
// kTooFewPoints (below four poses), kNotFinite, kNotPositive, kSingular (the poses stand on one
// line).
[[nodiscard]] Result<ReferenceReport> what_moved(std::span<const PoseResidual> poses,
                                                 double sigma_m);

}  // namespace armsig::drift
