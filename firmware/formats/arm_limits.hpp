// SPDX-License-Identifier: MIT
// How far an arm may be from its drawing and still be the arm of the drawing.
#pragma once

#include "core/base/pose.hpp"

namespace armsig::tool {

// Far beyond what a workshop builds, near enough to tell another arm, or a wrong unit, by.
struct ArmLimits {
  double tilt_rad = radians(2);  // of an axis against the one before it
  double shift_share = 0.015;    // of an axis against the one before it, of the arm's reach
  double least_shift_m = 5e-3;   // and at least
  double zero_rad = radians(45);
  double zero_share = 0.2;  // of the reach, for the zero of a prismatic joint
};

}  // namespace armsig::tool
