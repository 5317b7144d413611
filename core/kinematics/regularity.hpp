// SPDX-License-Identifier: MIT
// How well the joints move frame n, from its Jacobian.
#pragma once

#include "core/kinematics/forward.hpp"

namespace armsig::kinematics {

struct Regularity {
  // The least pivot of the elimination, position rows in units of the arm's reach: 0 at a
  // singularity, about 0.1 to 1 away from them. Dimensions that the arm lacks joints for don't
  // count.
  double value = 0;
  int position_dimensions = 0;
  int rotation_dimensions = 0;  // without disturbing the position
};

// Gaussian elimination with complete pivoting, position rows first: a pivot below `threshold` is no
// dimension. `J` holds finite numbers.
[[nodiscard]] Regularity regularity(const PoseAndJacobian& J, double threshold);

}  // namespace armsig::kinematics
