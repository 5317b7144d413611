// SPDX-License-Identifier: MIT
#include "firmware/controller/signature_figures.hpp"

namespace armsig::controller {

void SignatureFigures::tell(Line& line) const {
  line.text(" signature=");
  if (number_ == 0) {
    line.text("candidate");
  } else {
    line.integer(number_);
  }
  if (accuracy_.predicted) tell_predicted(line, *accuracy_.predicted);
  if (const auto& validated = accuracy_.validated) {
    line.text(" validation_rms_mm=").number(1e3 * validated->rms_m, 4);
    if (validated->poses > 0) line.text(" validation_poses=").integer(validated->poses);
  }
  line.text(" air_c=").number(air_celsius_, 1);
}

void tell_predicted(Line& line, const ToolAccuracy::Predicted& predicted, std::string_view prefix) {
  line.text(" ").text(prefix).text("predicted_tool_error_mm=").number(1e3 * predicted.rms_m, 4);
  line.text(" ").text(prefix).text("predicted_region=").text(name(predicted.region));
}

}  // namespace armsig::controller
