// SPDX-License-Identifier: MIT
// How well the joints move frame n, from its Jacobian.
#pragma once

#include "core/kinematics/forward.hpp"

namespace armsig::kinematics {

struct Regularity {
  // Manipulability (Yoshikawa 1985) without units: the volume sqrt(det(J J^T)) that unit joint
  // rates span, of six columns |det J|, of fewer sqrt(det(J^T J)); lengths, of the rows for the
  // position and of prismatic readings, count in units of Chain::length. 0 at a singularity, about
  // 0.1 to 1 away from them. Of six joints or more it does not depend on which point of the last
  // link frame n is.
  double value = 0;
  // Dimensions that the joints can change: position, and orientation without disturbing it.
  int position_dimensions = 0;
  int rotation_dimensions = 0;
};

// `at` holds finite numbers. Dimensions are counted by Gaussian elimination with complete pivoting,
// position rows first: a pivot below `threshold` is none.
[[nodiscard]] Regularity regularity(const Chain& chain, const PoseAndJacobian& at,
                                    double threshold);

}  // namespace armsig::kinematics
