// SPDX-License-Identifier: MIT
#include "firmware/host_tool/reading/measurement_log.hpp"

#include <algorithm>

namespace armsig::tool {

void MeasurementLog::add(const MeasurementRow& row, const std::optional<SensorDescription>& sensor,
                         double scale) {
  calibration::Observation observation;
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
    ranges_ = true;
    observation.kind = calibration::ObservationKind::kRange;
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

void MeasurementLog::add_located(const Vector3& p_S) {
  calibration::Observation position = observations_.back();
  position.kind = calibration::ObservationKind::kPosition;
  position.p_S = p_S;
  located_.push_back(position);
  located_numbers_.push_back(target_numbers_.back());
}

std::optional<int> MeasurementLog::index_targets(const FixedVector<Target, kMaxTargets>& targets) {
  const auto index = [&](std::vector<calibration::Observation>& rows,
                         const std::vector<int>& numbers) -> std::optional<int> {
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const auto* found = std::ranges::find(targets, numbers[k], &Target::number);
      if (found == targets.end()) return numbers[k];
      rows[k].target = static_cast<std::size_t>(found - targets.begin());
    }
    return std::nullopt;
  };
  if (const auto unknown = index(observations_, target_numbers_)) return unknown;
  return index(located_, located_numbers_);
}

const calibration::Observation* MeasurementLog::first_position(int target) const {
  const std::vector<int>& numbers = located_.empty() ? target_numbers_ : located_numbers_;
  const auto found = std::ranges::find(numbers, target);
  if (found == numbers.end()) return nullptr;
  const auto& first = positions()[static_cast<std::size_t>(found - numbers.begin())];
  return first.kind == calibration::ObservationKind::kPosition ? &first : nullptr;
}

std::vector<std::size_t> MeasurementLog::rejected_lines(
    const std::vector<calibration::RowOutcome>& outcomes) const {
  std::vector<std::size_t> lines;
  for (std::size_t k = 0; k < outcomes.size(); ++k) {
    if (outcomes[k].rejected && (lines.empty() || lines.back() != lines_[k])) {
      lines.push_back(lines_[k]);
    }
  }
  return lines;
}

std::vector<DisbelievedReceiver> MeasurementLog::disbelieved_receivers(
    const std::vector<calibration::RowOutcome>& outcomes) const {
  constexpr std::size_t kFewest = 3;
  std::map<std::size_t, DisbelievedReceiver> all;
  for (std::size_t k = 0; k < outcomes.size(); ++k) {
    const calibration::Observation& row = observations_[k];
    if (row.kind != calibration::ObservationKind::kRange) continue;
    DisbelievedReceiver& receiver = all[row.receiver];
    receiver.number = row.receiver + 1;
    ++receiver.ranges;
    receiver.rejected += outcomes[k].rejected ? 1 : 0;
  }
  std::vector<DisbelievedReceiver> disbelieved;
  for (const auto& [index, receiver] : all) {
    if (receiver.rejected < kFewest || 2 * receiver.rejected <= receiver.ranges) continue;
    disbelieved.push_back(receiver);
  }
  return disbelieved;
}

std::vector<Target> MeasurementLog::targets(std::size_t joints) const {
  std::vector<Target> targets;
  targets.reserve(outermost_sweep_.size());
  for (const auto& [number, sweep] : outermost_sweep_) {
    targets.push_back({.number = number, .link = sweep == 0 ? joints : sweep});
  }
  return targets;
}

}  // namespace armsig::tool
