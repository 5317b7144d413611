// SPDX-License-Identifier: MIT
#include "firmware/host_tool/measurement_log.hpp"

#include <algorithm>

namespace armsig::tool {

void MeasurementLog::add(const MeasurementRow& row, const std::optional<SensorDescription>& sensor,
                         double scale) {
  refinement::Observation observation;
  observation.sweep = row.sweep;
  observation.readings = row.q;
  const auto keep = [&] {
    observations_.push_back(observation);
    lines_.push_back(row.line);
    target_numbers_.push_back(row.target);
  };
  const std::size_t before = observations_.size();
  if (row.p_S) {
    observation.p_S = *row.p_S;
    observation.sigma_m = row.sigma_m.value_or(0);
    keep();
  }
  for (std::size_t k = 0; sensor && k < row.ranges_m.size(); ++k) {
    if (!row.ranges_m[k]) continue;
    observation.kind = refinement::ObservationKind::kRange;
    observation.receiver = k;
    observation.range_m = scale * *row.ranges_m[k];
    observation.sigma_m = row.sigma_m.value_or(sensor->range_sigma_m);
    keep();
  }
  if (observations_.size() == before) return;
  auto& outermost = outermost_sweep_.try_emplace(row.target, row.sweep).first->second;
  if (row.sweep == 0 || outermost == 0) {
    outermost = 0;
  } else {
    outermost = std::max(outermost, row.sweep);
  }
}

std::optional<int> MeasurementLog::index_targets(const FixedVector<Target, kMaxTargets>& targets) {
  for (std::size_t k = 0; k < observations_.size(); ++k) {
    const auto* found = std::ranges::find(targets, target_numbers_[k], &Target::number);
    if (found == targets.end()) return target_numbers_[k];
    observations_[k].target = static_cast<std::size_t>(found - targets.begin());
  }
  return std::nullopt;
}

const refinement::Observation* MeasurementLog::first_position(int target) const {
  for (std::size_t k = 0; k < observations_.size(); ++k) {
    if (target_numbers_[k] == target &&
        observations_[k].kind == refinement::ObservationKind::kPosition) {
      return &observations_[k];
    }
  }
  return nullptr;
}

std::vector<Target> MeasurementLog::targets(std::size_t joints) const {
  std::vector<Target> targets;
  for (const auto& [number, sweep] : outermost_sweep_) {
    targets.push_back({.number = number, .link = sweep == 0 ? joints : sweep});
  }
  return targets;
}

}  // namespace armsig::tool
