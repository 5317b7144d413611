// SPDX-License-Identifier: MIT
// What a person wants to know first: how much better, how sure, what to do next.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/host_tool/report/pose_residuals.hpp"
#include "firmware/host_tool/report/sweep_picture.hpp"
#include "firmware/host_tool/report/tool_error_map.hpp"

namespace armsig::tool {

// One figure of the tool's error. Two figures are comparable only over the same poses.
struct ErrorFigure {
  std::string name;  // "Signature"
  std::string over;  // the poses that it is of
  double rms_m = 0;
};

// The one figure that stands for a signature: of poses that no fit has used, or that were left out
// of a fit each.
struct ValidationFigure {
  double rms_m = 0;
  std::size_t poses = 0;  // 0: not recorded
  bool in_turn = false;   // each left out of a fit of all others
};
[[nodiscard]] std::optional<ValidationFigure> validation_figure(const SignatureRecord& record);
// "2773 validation poses, each left out of the fit in turn", "20 validation poses, which no fit has
// used".
[[nodiscard]] std::string poses_in_words(const ValidationFigure& figure);

struct Verdict {
  std::string headline;
  std::vector<ErrorFigure> before_after;  // what the headline compares: nominal model, signature
  std::optional<ValidationFigure> validation;
  std::vector<ErrorFigure> others;      // each with its own poses
  std::vector<std::string> sentences;   // how much better, how sure
  std::vector<std::string> next_steps;  // the most useful first
};

// Whether the rows left out were left out of a fit each, and are in the last; the features leave
// out poses beside their sweeps for good.
[[nodiscard]] bool left_out_in_turn(const SignatureRecord& record);

// `poses`: free poses that were measured, where there are any.
[[nodiscard]] Verdict verdict(const SignatureRecord& record,
                              const std::vector<SweepPicture>& sweeps,
                              const std::optional<ToolErrorMap>& map,
                              const std::optional<PoseResiduals>& poses);

// What the residuals of a sweep tell, in one or two sentences.
[[nodiscard]] std::string residuals_in_words(const SweepPicture& sweep);

}  // namespace armsig::tool
