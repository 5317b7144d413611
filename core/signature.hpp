// SPDX-License-Identifier: MIT
// The arm signature: the actual kinematics of one arm, as identified.
//
// The master are the link frames X_SL at the signature configuration, because they are well
// determined whatever the arm. The S-Model (4) and the pseudo Denavit-Hartenberg parameters
// (9)-(12) are derived from them; near parallel axes only the product of the latter is meaningful.
#pragma once

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "core/features/feature.hpp"
#include "core/s_model/s_model.hpp"

namespace armsig {

// An image of little memory has the one on the hand that its controller measures.
#ifdef ARMSIG_LITTLE_MEMORY
inline constexpr std::size_t kMaxTargets = 1;
#else
inline constexpr std::size_t kMaxTargets = 32;
#endif

// A target point: fixed to link `link` (1 = the link that joint 1 moves, n = the last).
struct Target {
  int number = 0;
  std::size_t link = 0;
  Vector3 p_S = Vector3::Zero();  // in the sensor frame, at the signature configuration
  Matrix3 covariance_m2 = Matrix3::Zero();
};

struct Signature {
  JointTypes types;
  JointVector configuration;           // the signature configuration, effective readings
  FixedVector<Pose, kMaxFrames> X_SL;  // link frames 0 ... n in the sensor frame, (15)
  FixedVector<s_model::Parameters, kMaxJoints> s_model;  // of B_i, (18)
  DhRows pseudo_dh;  // (9)-(12), offsets (19), first joint (22)-(23)
  FixedVector<Target, kMaxTargets> targets;
  FixedVector<features::JointFeature, kMaxJoints>
      features;  // what the sweeps said; empty if not from sweeps
  // False where the identified axes match those of the arm description in no way; worth a warning.
  bool description_matches = true;

  [[nodiscard]] std::size_t joint_count() const { return types.size(); }
};

}  // namespace armsig
