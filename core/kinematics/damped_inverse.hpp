// SPDX-License-Identifier: MIT
// Inverse kinematics for every case: any number of joints, singularities, limits, poses out of
// reach.
#pragma once

#include "core/kinematics/inverse.hpp"

namespace armsig::kinematics {

// Damped least squares (Levenberg-Marquardt) on the pose error inside the box of joint and step
// limits, from `start`; the box and the nearest solution of arms with more than six joints refer to
// `seed`. All numbers finite. Never fails: what was not met is told by the verdict.
[[nodiscard]] InverseSolution damped_inverse(const Chain& chain, const Pose& X_0n,
                                             const JointVector& start, const JointVector& seed,
                                             const InverseOptions& options);

}  // namespace armsig::kinematics
