// SPDX-License-Identifier: MIT
// Two signatures of one arm, joint by joint, from their documents.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/base/arm.hpp"

namespace armsig::fleet {

// How an axis lies on the link before it, against how it lay, and its zero.
struct JointDifference {
  double tilt_rad = 0;
  double shift_m = 0;
  double zero = 0;     // rad; m of a prismatic joint, as are the next two
  double map = 0;      // the largest change of its reading's map
  double gravity = 0;  // the largest change of what it gives way by, per metre of lever
  double adds_m = 0;   // to tool_rms_m
  JointType type = JointType::kRevolute;
};
struct SignatureComparison {
  std::vector<JointDifference> joints;
  double tool_rms_m = 0;  // over the work volume, base and tool fitted: the sum of all adds_m
  bool bends = false;     // either has maps or gravity
  bool whole = true;      // what they do at the tool is in the sums
};

// firmware/analysis/differences/differences.hpp with `before` as the drawing, at a point 0.1 m
// along the last axis: Denavit-Hartenberg rows say nothing near parallel axes, the lines of the
// axes do. None: a document is none, they are of other joints, or too different to be one arm's.
// Maps and gravity are in the sums but where a document does not say at which readings they count
// as nought. Joints that are coupled are taken as if they were not: no document says so.
[[nodiscard]] std::optional<SignatureComparison> compare_signatures(std::string_view before,
                                                                    std::string_view now);

}  // namespace armsig::fleet
