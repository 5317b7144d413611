// SPDX-License-Identifier: MIT
// The servo tick's inverse for six joints, away from singularities: Newton with the exact Jacobian.
#pragma once

#include <optional>

#include "core/kinematics/inverse.hpp"

namespace armsig::kinematics {

// The solution near `seed` (six readings; joints 4 to 6 revolute), or nothing where the damped
// method is needed: no convergence within a few steps, a singularity near the way, last three
// joints that don't turn the tool about three independent axes, a pose or reading that is refused.
// Joint and step limits are not looked at. `passes` gets the evaluations of the chain, less than
// options.max_iterations.
[[nodiscard]] std::optional<InverseSolution> newton_inverse(const Chain& chain, const Pose& X_0n,
                                                            const JointVector& seed,
                                                            const InverseOptions& options,
                                                            int& passes);

}  // namespace armsig::kinematics
