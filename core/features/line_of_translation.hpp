// SPDX-License-Identifier: MIT
// The line of translation of a prismatic joint, section 3.1 of the paper: the line that the target
// traces, from the points alone.
#pragma once

#include "core/base/error.hpp"
#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

struct LineOfTranslation {
  Vector3 direction_S = Vector3::UnitZ();  // unit; its sense is not told by a line
  Vector3 mean = Vector3::Zero();  // of the points, about the statistics' origin: on the line
};

// Two regressions, y = a1 x + a2 and z = b1 x + b2, with x the coordinate along which the points
// spread most.
// Errors: kSingular (the points coincide).
[[nodiscard]] Result<LineOfTranslation> line_of_translation(const Geometry& geometry);

}  // namespace armsig::features
