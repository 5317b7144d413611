// SPDX-License-Identifier: MIT
// What one joint does, and one row of a drawing: the factors that every chain is a product of.
#pragma once

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig {

// The motion of a joint along z: Rot(z, motion) of a revolute one, Trans(0, 0, motion) of a slide.
[[nodiscard]] inline Pose joint_motion(JointType type, double motion) {
  if (type == JointType::kPrismatic) return {Matrix3::Identity(), Vector3(0, 0, motion)};
  return {rotation_z(motion), Vector3::Zero()};
}

// A_i of (2) at a reading (an effective one: couplings applied).
[[nodiscard]] inline Pose link_transform(const DhJoint& row, double reading) {
  const bool revolute = row.type == JointType::kRevolute;
  const Matrix3 R_z = rotation_z(row.theta_rad + (revolute ? reading : 0));
  const Vector3 p(row.a_m, 0, row.d_m + (revolute ? 0 : reading));
  return {R_z * rotation_x(row.alpha_rad), R_z * p};
}

// Denavit-Hartenberg frames 0 ... n of the arm in frame 0 at effective readings, the products (1).
// Precondition: one reading a row.
[[nodiscard]] inline FixedVector<Pose, kMaxFrames> dh_frames(const DhRows& rows,
                                                             const JointVector& effective) {
  FixedVector<Pose, kMaxFrames> X_0F;
  X_0F.push_back({});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    X_0F.push_back(X_0F.back() * link_transform(rows[i], effective[i]));
  }
  return X_0F;
}

}  // namespace armsig
