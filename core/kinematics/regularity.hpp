// SPDX-License-Identifier: MIT
// How well the joints move frame n, from its Jacobian.
#pragma once

#include "core/kinematics/forward.hpp"

namespace armsig::kinematics {

// Manipulability (Yoshikawa 1985) without units: the volume sqrt(det(J J^T)) that unit joint rates
// span, of six columns |det J|, of fewer that of what their task determines (position_first.hpp),
// of those without one sqrt(det(J^T J)); lengths, of the rows for the position and of prismatic
// readings, count in units of Chain::length. 0 at a singularity, about 0.1 to 1 away from them. Of
// six joints or more it does not depend on which point of the last link frame n is. `at` holds
// finite numbers.
[[nodiscard]] double regularity(const Chain& chain, const PoseAndJacobian& at);

}  // namespace armsig::kinematics
