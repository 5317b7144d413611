// SPDX-License-Identifier: MIT
// The limits of a joint of a URDF file.
#pragma once

#include "core/base/arm.hpp"
#include "firmware/host_tool/imports/urdf_tree.hpp"

namespace armsig::tool {

struct UrdfLimits {
  JointLimits limits;
  bool beyond_counting = false;  // the file has limits, so far away that they mean none
};

// kNoLimits of a continuous joint, and of one whose limits are infinite or a thousand turns away.
// Refuses a joint without a limit, 0 to 0, which an exporter writes where none was given, limits
// the wrong way round, and such as only degrees or millimetres have.
[[nodiscard]] Read<UrdfLimits> urdf_limits(const UrdfJoint& joint);

}  // namespace armsig::tool
