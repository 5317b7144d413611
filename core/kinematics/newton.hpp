// SPDX-License-Identifier: MIT
// The servo tick's inverse for six joints, away from singularities: Newton with the exact Jacobian.
#pragma once

#include <optional>

#include "core/kinematics/inverse.hpp"

namespace armsig::kinematics {

// The solution near `seed` (six finite readings, a finite pose), or nothing where the damped method
// is needed: no convergence within a few steps, a singularity near the way, last three joints that
// don't turn the tool about three independent axes. Joint and step limits are not looked at.
[[nodiscard]] std::optional<InverseSolution> newton_inverse(const Chain& chain, const Pose& X_0n,
                                                            const JointVector& seed,
                                                            const InverseOptions& options);

}  // namespace armsig::kinematics
