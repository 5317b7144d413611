// SPDX-License-Identifier: MIT
// The joints of a URDF's path as those of a signature: which one's origin places each axis.
#pragma once

#include <vector>

#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/imports/urdf_tree.hpp"

namespace armsig::tool {

// A joint of the arm in the file: fixed joints, then the joint whose origin is to be corrected,
// then what turns with it about the same axis (a mimic joint comes before the one that it couples).
struct Stage {
  const UrdfJoint* corrected = nullptr;
  const UrdfJoint* moving = nullptr;  // the same, or the one behind its mimic joints
  Pose X_PF;                          // frame of `corrected`'s parent in the link before
  Pose X_JK;                          // the link beyond in `corrected`'s frame, at the readings

  [[nodiscard]] Pose X_PJ() const { return X_PF * corrected->X_PJ; }
};

struct StagedChain {
  FixedVector<Stage, kMaxJoints> stages;
  Pose X_KT;  // the tip in the last link that moves
};

[[nodiscard]] JointType type_of(const UrdfJoint& joint);

// A stage a joint of the signature, at its configuration: mimic joints follow the encoders; a
// coupled joint without any is told the angle between its links. The stages point into `path`.
// Refuses another count or other types of joints, at an element of the path or at `robot`.
[[nodiscard]] Read<StagedChain> staged_chain(const std::vector<UrdfJoint>& path,
                                             const tinyxml2::XMLElement& robot,
                                             const SignatureRecord& record);

}  // namespace armsig::tool
