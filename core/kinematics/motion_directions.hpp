// SPDX-License-Identifier: MIT
// Directions of all joints together that the Jacobian of frame n tells.
#pragma once

#include <Eigen/Core>

#include "core/kinematics/forward.hpp"
#include "core/kinematics/joint_box.hpp"

namespace armsig::kinematics {

// That along which frame n moves least, its largest entry 1 or -1; zero where it is not told. `n`
// joints.
[[nodiscard]] Joints weakest_direction(const Jacobian& J, Eigen::Index n);

// The part of `v` that leaves frame n where it is, of an arm with more than six joints.
[[nodiscard]] Joints self_motion(const Jacobian& J, const Joints& v);

}  // namespace armsig::kinematics
