// SPDX-License-Identifier: MIT
// A table of tool poses that make the real arm arrive.
#pragma once

#include <vector>

#include "firmware/host_tool/programs/correct_program.hpp"

namespace armsig::tool {

struct CorrectedPoses {
  std::vector<CorrectedTarget> targets;  // one a pose; its line is the row, from 1
  std::vector<LeftAsItIs> left;
  std::vector<Pose> poses;  // those that are left, as they were
};

// `seeds`: none, one for all of the poses, or one for each.
[[nodiscard]] CorrectedPoses corrected_poses(const std::vector<Pose>& poses,
                                             const ControllerView& view,
                                             const std::vector<JointVector>& seeds);

}  // namespace armsig::tool
