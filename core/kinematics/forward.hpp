// SPDX-License-Identifier: MIT
// Forward kinematics of the pseudo Denavit-Hartenberg model, (1) and (21): pose and geometric
// Jacobian of frame n in frame 0.
#pragma once

#include "core/base/error.hpp"
#include "core/base/pose.hpp"
#include "core/kinematics/chain.hpp"

namespace armsig::kinematics {

// Column i: velocity of frame n per unit of joint i's rate, expressed in frame 0 and taken at the
// origin of frame n; rows 0-2 linear [m/s], rows 3-5 angular [rad/s]. Columns beyond the joint
// count are zero.
using Jacobian = Eigen::Matrix<double, 6, kMaxJoints>;

struct PoseAndJacobian {
  Pose X_0n;
  Jacobian J;  // without a value until it is computed

  // Not defaulted, so that a Result does not set half a kilobyte to zero first.
  // NOLINTNEXTLINE(modernize-use-equals-default, cppcoreguidelines-pro-type-member-init)
  PoseAndJacobian() {}
};

// Pose of frame n in frame 0 at readings `q`, as many as the chain has joints.
// Errors: kNotFinite if a reading is NaN or infinite.
[[nodiscard]] Result<Pose> forward(const Chain& chain, const JointVector& q);

// The same with the geometric Jacobian, in one pass.
// Errors: kNotFinite.
[[nodiscard]] Result<PoseAndJacobian> forward_with_jacobian(const Chain& chain,
                                                            const JointVector& q);

}  // namespace armsig::kinematics
