// SPDX-License-Identifier: MIT
#include "firmware/library/joint_frames.hpp"

#include <cmath>

#include "core/frames/alignment.hpp"
#include "core/identification.hpp"

namespace armsig::tool {
namespace {

// Below this a drawing's x axis is along the joint axis and gives it no direction.
constexpr double kLeastAcross = 1e-3;
// A frame of the drawing further than this from the arm is an artefact of nearly parallel axes.
constexpr double kFarFromArm_m = 5;

Pose motion(JointType type, double q) {
  if (type == JointType::kRevolute) return {rotation_z(q), Vector3::Zero()};
  return {Matrix3::Identity(), Vector3(0, 0, q)};
}

// The frame `X_SN` of the drawing, moved onto the axis through `point`, which is near the arm,
// along `direction`.
Pose moved_onto_axis(const Pose& X_SN, const Vector3& point, const Vector3& direction) {
  const Vector3 z = direction.normalized();
  Vector3 x = X_SN.R.col(0) - z * z.dot(X_SN.R.col(0));
  x = x.norm() > kLeastAcross ? Vector3(x.normalized()) : any_perpendicular(z);
  Pose X_SK;
  X_SK.R << x, z.cross(x), z;
  const double along = z.dot(X_SN.p - point);
  X_SK.p = point + z * (std::abs(along) < kFarFromArm_m ? along : 0.0);
  return X_SK;
}

}  // namespace

JointFrames joint_frames(const Signature& signature, const Arm& nominal) {
  const Signature drawn = signature_of(nominal, signature.configuration, Pose{}, {});
  JointFrames frames;
  frames.X_SB = frames::align(frames::axis_lines(signature), frames::axis_lines(drawn)).X_AB;

  Pose X_SN = frames.X_SB;  // Denavit-Hartenberg frame of the drawing
  Pose X_SK_before = X_SN;  // link frame before joint i
  for (std::size_t i = 0; i < signature.joint_count(); ++i) {
    const DhJoint& row = nominal.joints[i];
    const double q = signature.configuration[i];
    X_SN = X_SN * Pose{rotation_z(row.theta_rad), Vector3(0, 0, row.d_m)} * motion(row.type, q);
    // A slide has a direction alone: its line stays where the drawing has it.
    const Vector3& point = row.type == JointType::kRevolute ? signature.X_SL[i].p : X_SN.p;
    const Pose X_SK = moved_onto_axis(X_SN, point, signature.X_SL[i].R.col(2));
    frames.X_PJ.push_back(X_SK_before.inverse() * X_SK * motion(row.type, -q));
    frames.X_SK.push_back(X_SK);
    frames.X_SN.push_back(X_SN);
    X_SK_before = X_SK;
    X_SN = X_SN * Pose{rotation_x(row.alpha_rad), Vector3(row.a_m, 0, 0)};
  }
  frames.X_KL = X_SK_before.inverse() * signature.X_SL.back();
  return frames;
}

Pose flange_in_sensor(const JointFrames& frames, const Arm& nominal) {
  const DhJoint& last = nominal.joints.back();
  return frames.X_SK.back() * Pose{rotation_x(last.alpha_rad), Vector3(last.a_m, 0, 0)};
}

Pose last_link_pose(const JointFrames& frames, const JointTypes& types, const JointVector& q) {
  Pose X_SK = frames.X_SB;
  for (std::size_t i = 0; i < types.size(); ++i) {
    X_SK = X_SK * frames.X_PJ[i] * motion(types[i], q[i]);
  }
  return X_SK * frames.X_KL;
}

}  // namespace armsig::tool
