// SPDX-License-Identifier: MIT
// Inverse kinematics for every case: any number of joints, singularities, limits, poses out of
// reach.
#pragma once

#include "core/kinematics/inverse.hpp"

namespace armsig::kinematics {

// Damped least squares (Levenberg-Marquardt) on the pose error inside the box of joint and step
// limits, from `seed`, to which the box and the nearest solution of arms with more than six joints
// refer. The error of the orientation is the rotation vector, of up to half a turn. Inputs as
// inverse() admits them; `passes` of options.max_iterations, less than all, are used up already.
// Never fails: what was not met is told by the verdict.
[[nodiscard]] InverseSolution damped_inverse(const Chain& chain, const Pose& X_0n,
                                             const JointVector& seed, const InverseOptions& options,
                                             int passes);

}  // namespace armsig::kinematics
