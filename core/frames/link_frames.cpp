// SPDX-License-Identifier: MIT
#include "core/frames/link_frames.hpp"

#include <cmath>

namespace armsig::frames {
namespace {

// Columns n, o, a of (16): a is kept, n is made perpendicular to it.
Matrix3 triad(const Vector3& axis, const Vector3& towards) {
  constexpr double kLeastSine = 1e-6;
  const Vector3 z = axis.normalized();
  const Vector3 across = towards - z * z.dot(towards);
  Matrix3 R;
  const bool usable = across.norm() > kLeastSine * towards.norm();
  R.col(0) = usable ? Vector3(across.normalized()) : any_perpendicular(z);
  R.col(1) = z.cross(R.col(0)).normalized();
  R.col(2) = z;
  return R;
}

}  // namespace

FixedVector<Pose, kMaxFrames> link_frames(
    const FixedVector<features::JointFeature, kMaxJoints>& features,
    const JointVector& configuration) {
  ARMSIG_CHECK(!features.empty() && configuration.size() == features.size());
  FixedVector<Pose, kMaxFrames> X_SL;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const features::JointFeature& joint = features[i];
    if (joint.type == JointType::kRevolute) {
      X_SL.push_back({triad(joint.axis_S, joint.radial_S), joint.point_S});
    } else {
      X_SL.push_back({triad(joint.axis_S, any_perpendicular(joint.axis_S.normalized())),
                      joint.target_at(configuration[i])});
    }
  }
  X_SL.push_back(Pose(X_SL.back()));
  return X_SL;
}

KnownLinkFrames link_frames(const DhRows& rows, const JointVector& readings) {
  ARMSIG_CHECK(!rows.empty() && readings.size() == rows.size());
  KnownLinkFrames frames;
  frames.X_0L.push_back(Pose{});
  frames.along_m.push_back(0.0);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const DhJoint& row = rows[i];
    const bool revolute = row.type == JointType::kRevolute;
    const double theta_rad = revolute ? row.theta_rad + readings[i] : row.theta_rad;
    const double d_m = (revolute ? row.d_m : row.d_m + readings[i]) - frames.along_m[i];
    const double s_alpha = std::sin(row.alpha_rad);
    const double c_alpha = std::cos(row.alpha_rad);
    // (2) followed by Trans(0, 0, along), along = -d c_alpha, with the terms that cancel left out.
    const bool last = i + 1 == rows.size();
    const double along_m = last ? 0.0 : -d_m * c_alpha;
    const Vector3 p = last ? Vector3(row.a_m, 0, d_m)
                           : Vector3(row.a_m, d_m * s_alpha * c_alpha, d_m * s_alpha * s_alpha);
    const Matrix3 R_theta = rotation_z(theta_rad);
    frames.X_0L.push_back(frames.X_0L[i] * Pose{R_theta * rotation_x(row.alpha_rad), R_theta * p});
    frames.along_m.push_back(along_m);
  }
  return frames;
}

}  // namespace armsig::frames
