// SPDX-License-Identifier: MIT
#include "firmware/host_tool/identification/nominal_fit.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/calibration/row.hpp"
#include "firmware/analysis/starts/start.hpp"

namespace armsig::tool {

std::optional<ResidualSummary> nominal_residuals(
    const Arm& nominal, std::span<const calibration::Observation> log,
    std::span<const calibration::Observation> positions, std::span<const Target> targets,
    const calibration::Receivers& receivers, std::span<const calibration::RowOutcome> judged) {
  const auto fitted = calibration::fit_base_and_tool(nominal, positions, targets);
  if (!fitted) return std::nullopt;
  return nominal_residuals(nominal, *fitted, log, targets, receivers, judged);
}

std::optional<ResidualSummary> nominal_residuals(const Arm& nominal,
                                                 const calibration::BaseAndTool& fitted,
                                                 std::span<const calibration::Observation> log,
                                                 std::span<const Target> targets,
                                                 const calibration::Receivers& receivers,
                                                 std::span<const calibration::RowOutcome> judged) {
  const auto drawn = std::make_unique<calibration::Refined>();
  drawn->signature = calibration::drawn_signature(nominal, fitted, log, targets);
  drawn->readings.couplings = nominal.couplings;
  const calibration::PoeChain chain(drawn->signature, drawn->readings);
  ResidualSummary summary;
  for (std::size_t k = 0; k < log.size(); ++k) {
    if (judged[k].rejected) continue;
    const calibration::Observation& row = log[k];
    const double residual_m = calibration::residual_length(
        *drawn, receivers, row,
        chain.point(chain.motion(row.readings), drawn->signature.targets[row.target]));
    ++summary.rows;
    summary.mean_m += residual_m;
    summary.rms_m += residual_m * residual_m;
    summary.largest_m = std::max(summary.largest_m, residual_m);
  }
  if (summary.rows == 0) return std::nullopt;
  summary.mean_m /= static_cast<double>(summary.rows);
  summary.rms_m = std::sqrt(summary.rms_m / static_cast<double>(summary.rows));
  return summary;
}

}  // namespace armsig::tool
