// SPDX-License-Identifier: MIT
// Two signatures of one arm, joint by joint, from their documents.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/base/arm.hpp"

namespace armsig::fleet {

// The arm that a document describes: `theta1_deg= d1_mm= a1_mm= alpha1_deg= theta2_deg= ...`, as
// the controller tells it. The document does not say which joints are prismatic: every joint is
// taken to be revolute, with a whole turn. None: it is no such document.
[[nodiscard]] std::optional<Arm> arm_of_document(std::string_view document);

// How an axis lies on the link before it, against how it lay, and its zero.
struct JointDifference {
  double tilt_rad = 0;
  double shift_m = 0;
  double zero_rad = 0;
  double adds_m = 0;  // to tool_rms_m
};
struct SignatureComparison {
  std::vector<JointDifference> joints;
  double tool_rms_m = 0;  // over the work volume, base and tool fitted: the sum of all adds_m
};

// core/evaluation/differences.hpp with `before` as the drawing, at a point 0.1 m along the last
// axis: Denavit-Hartenberg rows say nothing near parallel axes, the lines of the axes do. None: a
// document is none, they are of other numbers of joints, or too different to be one arm's.
[[nodiscard]] std::optional<SignatureComparison> compare_signatures(std::string_view before,
                                                                    std::string_view now);

}  // namespace armsig::fleet
