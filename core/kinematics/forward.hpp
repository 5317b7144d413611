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
template <typename Scalar>
using JacobianT = Eigen::Matrix<Scalar, 6, kMaxJoints>;
using Jacobian = JacobianT<double>;

template <typename Scalar>
struct PoseAndJacobianT {
  PoseT<Scalar> X_0n;
  JacobianT<Scalar> J;  // without a value until it is computed
  std::size_t joint_count = 0;

  // Not defaulted, so that a Result does not set half a kilobyte to zero first.
  // NOLINTNEXTLINE(modernize-use-equals-default, cppcoreguidelines-pro-type-member-init)
  PoseAndJacobianT() {}
};
using PoseAndJacobian = PoseAndJacobianT<double>;

template <typename Scalar>
using ReadingsT = FixedVector<Scalar, kMaxJoints>;  // JointVector in double precision

// Pose of frame n in frame 0 at readings `q`, as many as the chain has joints.
// Errors: kNotFinite if a reading is NaN or infinite.
[[nodiscard]] Result<Pose> forward(const Chain& chain, const JointVector& q);
[[nodiscard]] Result<PoseT<float>> forward(const ChainT<float>& chain, const ReadingsT<float>& q);

// The same with the geometric Jacobian, in one pass.
// Errors: kNotFinite.
[[nodiscard]] Result<PoseAndJacobian> forward_with_jacobian(const Chain& chain,
                                                            const JointVector& q);
[[nodiscard]] Result<PoseAndJacobianT<float>> forward_with_jacobian(const ChainT<float>& chain,
                                                                    const ReadingsT<float>& q);

}  // namespace armsig::kinematics
