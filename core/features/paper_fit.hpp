// SPDX-License-Identifier: MIT
// The paper's path: the circle from (13) and (14), the line of translation, completed by what only
// the joint reading tells: the positive sense (section 3.2.2) and where the target is at the origin
// reading.
#pragma once

#include "core/base/error.hpp"
#include "core/features/encoder_circle.hpp"
#include "core/features/encoder_line.hpp"
#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

// The covariances are first-order, for noise that is alike in all directions of the plane (circle).
// The paper takes the direction of the first target (17); here the reading makes all targets vote.
// Errors: kSingular.
[[nodiscard]] Result<CircleFit> paper_circle(const SweepStatistics& statistics);
[[nodiscard]] Result<LineFit> paper_line(const SweepStatistics& statistics);

}  // namespace armsig::features
