// SPDX-License-Identifier: MIT
// armsig plan --instrument: where sockets, planes and anchors are to stand, and what to touch.
#pragma once

#include <string>

#include "firmware/formats/arm_file.hpp"
#include "firmware/host_tool/commands/pose_options.hpp"

namespace armsig::tool {

struct PlacePlanOptions {
  std::string instrument;
  std::string drawing;
  double accuracy_mm = 0.1;
  double sigma_mm = 0.05;
  std::size_t most = 200;
};

// `arm`, named `named`, with the margin taken off its limits.
[[nodiscard]] Attempt<ExitStatus> plan_places(const PoseOptions& poses,
                                              const PlacePlanOptions& options,
                                              const std::string& named, const ArmDescription& arm);

}  // namespace armsig::tool
