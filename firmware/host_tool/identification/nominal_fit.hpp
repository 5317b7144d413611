// SPDX-License-Identifier: MIT
// What the drawing alone would make of some rows: the figure to compare a signature with.
#pragma once

#include <optional>
#include <span>

#include "core/calibration/observation.hpp"
#include "core/signature.hpp"
#include "firmware/analysis/starts/base_and_tool.hpp"

namespace armsig::tool {

struct ResidualSummary {
  std::size_t rows = 0;
  double mean_m = 0;  // of the residual lengths
  double rms_m = 0;
  double largest_m = 0;
};

// Residuals of the arm as drawn, its base and targets fitted to `positions`, over those rows of
// `log` that `judged` does not reject. Nothing where the positions do not tell base and targets.
[[nodiscard]] std::optional<ResidualSummary> nominal_residuals(
    const Arm& nominal, std::span<const calibration::Observation> log,
    std::span<const calibration::Observation> positions, std::span<const Target> targets,
    const calibration::Receivers& receivers, std::span<const calibration::RowOutcome> judged);

// The same with base and targets as `fitted`.
[[nodiscard]] std::optional<ResidualSummary> nominal_residuals(
    const Arm& nominal, const calibration::BaseAndTool& fitted,
    std::span<const calibration::Observation> log, std::span<const Target> targets,
    const calibration::Receivers& receivers, std::span<const calibration::RowOutcome> judged);

}  // namespace armsig::tool
