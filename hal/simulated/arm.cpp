// SPDX-License-Identifier: MIT
#include "hal/simulated/arm.hpp"

#include <cmath>

namespace armsig::simulated {

namespace {

// The matrix (2) of the paper, element by element.
Pose joint_transform(const DhJoint& joint, double reading) {
  const bool turns = joint.type == JointType::kRevolute;
  const double theta = turns ? joint.theta_rad + reading : joint.theta_rad;
  const double d = turns ? joint.d_m : joint.d_m + reading;
  const double ct = std::cos(theta);
  const double st = std::sin(theta);
  const double ca = std::cos(joint.alpha_rad);
  const double sa = std::sin(joint.alpha_rad);
  return {Matrix3{{ct, -st * ca, st * sa}, {st, ct * ca, -ct * sa}, {0, sa, ca}},
          Vector3(joint.a_m * ct, joint.a_m * st, d)};
}

}  // namespace

SimulatedArm grown(const SimulatedArm& arm, double share) {
  SimulatedArm grown = arm;
  for (DhJoint& joint : grown.arm.joints) {
    joint.a_m *= 1 + share;
    joint.d_m *= 1 + share;
  }
  for (Target& target : grown.targets) target.p_L *= 1 + share;
  return grown;
}

Pose link_pose(const SimulatedArm& arm, const JointVector& readings, std::size_t link) {
  ARMSIG_CHECK(link <= arm.arm.joints.size());
  const JointVector effective = effective_readings(arm.arm, readings);
  Pose X_SL = arm.X_S0;
  for (std::size_t i = 0; i < link; ++i)
    X_SL = X_SL * joint_transform(arm.arm.joints[i], effective[i]);
  return X_SL;
}

FixedVector<Pose, kMaxFrames> link_poses(const SimulatedArm& arm, const JointVector& readings) {
  const JointVector effective = effective_readings(arm.arm, readings);
  FixedVector<Pose, kMaxFrames> X_SL;
  X_SL.push_back(arm.X_S0);
  for (std::size_t i = 0; i < arm.arm.joints.size(); ++i) {
    X_SL.push_back(X_SL.back() * joint_transform(arm.arm.joints[i], effective[i]));
  }
  return X_SL;
}

Vector3 target_position(const SimulatedArm& arm, const JointVector& readings,
                        const Target& target) {
  return link_pose(arm, readings, target.link) * target.p_L;
}

}  // namespace armsig::simulated
