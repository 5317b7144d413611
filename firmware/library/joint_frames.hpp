// SPDX-License-Identifier: MIT
// A signature as a tree of links and joints, the way URDF and the kinematics files of Universal
// Robots describe an arm: every joint turns about, or slides along, the z axis of its own frame.
//
// The frames come from the axes, not from Denavit-Hartenberg parameters, so that nearly parallel
// axes cost no digits. Each stands where the drawing puts it, moved onto the actual axis by the
// shortest way: meshes and limits made for the drawing keep their meaning.
#pragma once

#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

struct JointFrames {
  Pose X_SB;  // base of the drawing in the sensor frame, laid over the actual axes
  // Joint i in the link before it (the base for joint 1) at reading zero.
  FixedVector<Pose, kMaxJoints> X_PJ;
  // Link i (1 ... n, at index i - 1) in the sensor frame, at the signature configuration.
  FixedVector<Pose, kMaxJoints> X_SK;
  FixedVector<Pose, kMaxJoints> X_SN;  // the same where the drawing has them, laid over the axes
  Pose X_KL;  // the frame that `armsig predict` answers for, in the last link
};

// `nominal`: the model whose frames are laid over the axes of `signature`, of as many joints.
[[nodiscard]] JointFrames joint_frames(const Signature& signature, const Arm& nominal);
[[nodiscard]] inline JointFrames joint_frames(const SignatureRecord& record) {
  return joint_frames(record.signature, record.nominal);
}

// The flange of the nominal model on the actual last link, in the sensor frame at the signature
// configuration.
[[nodiscard]] Pose flange_in_sensor(const JointFrames& frames, const Arm& nominal);

// Pose of the last link's frame in the sensor frame: X_SB prod X_PJ motion(q) X_KL.
[[nodiscard]] Pose last_link_pose(const JointFrames& frames, const JointTypes& types,
                                  const JointVector& q);

}  // namespace armsig::tool
