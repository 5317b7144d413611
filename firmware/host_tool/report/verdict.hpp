// SPDX-License-Identifier: MIT
// What a person wants to know first: how much better, how sure, what to do next.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/host_tool/report/sweep_picture.hpp"
#include "firmware/host_tool/report/tool_error_map.hpp"

namespace armsig::tool {

struct Verdict {
  std::string headline;
  std::vector<std::string> sentences;   // how much better, how sure
  std::vector<std::string> next_steps;  // the most useful first
};

// Whether the rows left out were left out of a fit each, and are in the last; the features leave
// out poses beside their sweeps for good.
[[nodiscard]] bool left_out_in_turn(const SignatureRecord& record);
// "20 validation poses, which no fit has used,".
[[nodiscard]] std::string validation_poses_in_words(const ToolAccuracy::Validated& validated);

[[nodiscard]] Verdict verdict(const SignatureRecord& record,
                              const std::vector<SweepPicture>& sweeps,
                              const std::optional<ToolErrorMap>& map);

// What the residuals of a sweep tell, in one or two sentences.
[[nodiscard]] std::string residuals_in_words(const SweepPicture& sweep);

}  // namespace armsig::tool
