// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/measured_sweeps.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/host_tool/reading/copied_rows.hpp"
#include "firmware/host_tool/reading/ranging.hpp"

namespace armsig::tool {

void MeasuredSweeps::add(const LocatedRow& row) {
  if (row.sweep == 0) {
    ++mixed;
    for (std::size_t i = 0; i < row.q.size(); ++i) {
      if (mixed_reach.size() == i) mixed_reach.push_back({row.q[i], row.q[i]});
      mixed_reach[i].lower = std::min(mixed_reach[i].lower, row.q[i]);
      mixed_reach[i].upper = std::max(mixed_reach[i].upper, row.q[i]);
    }
    return;
  }
  const std::size_t joint = row.sweep - 1;
  const auto key = [](const MeasuredSweep& sweep) { return std::pair(sweep.joint, sweep.target); };
  auto place = std::ranges::lower_bound(sweeps, std::pair(joint, row.target), {}, key);
  if (place == sweeps.end() || key(*place) != std::pair(joint, row.target)) {
    place = sweeps.insert(place, {.joint = joint, .target = row.target, .points = {}});
  }
  place->points.push_back({row.q[joint], row.p_S, row.covariance_m2});
}

void MeasuredSweeps::compare(const LocatedRow& row, const Vector3& predicted_S) {
  misses_m.push_back((row.p_S - predicted_S).norm());
  sum_S += row.p_S;
  squares_m2 += row.p_S.squaredNorm();
}

double MeasuredSweeps::missed_share() const {
  if (misses_m.empty()) return 0;
  std::vector<double> sorted = misses_m;
  std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2));
  const auto count = static_cast<double>(sorted.size());
  const double spread_m2 = squares_m2 / count - (sum_S / count).squaredNorm();
  return sorted[sorted.size() / 2] / std::sqrt(std::max(spread_m2, 1e-12));
}

FixedVector<JointLimits, kMaxJoints> measured_reach(const MeasuredSweeps& measured) {
  FixedVector<JointLimits, kMaxJoints> reach;
  for (const MeasuredPose& row : measured.rows_located) {
    for (std::size_t i = 0; i < row.q.size(); ++i) {
      if (reach.size() == i) reach.push_back({row.q[i], row.q[i]});
      reach[i].lower = std::min(reach[i].lower, row.q[i]);
      reach[i].upper = std::max(reach[i].upper, row.q[i]);
    }
  }
  return reach;
}

namespace {

// Nothing where the row gives no position.
std::optional<LocatedRow> located(const MeasurementRow& row, const Arm& nominal,
                                  const std::optional<SensorDescription>& sensor, double scale) {
  LocatedRow result{.line = row.line,
                    .sweep = row.sweep,
                    .target = row.target,
                    .q = effective_readings(nominal, row.q)};
  if (row.ranges_m.empty()) {
    if (!row.p_S) return std::nullopt;
    result.p_S = *row.p_S;
    if (row.sigma_m) result.covariance_m2 = Matrix3::Identity() * (*row.sigma_m * *row.sigma_m);
    return result;
  }
  const auto position = locate(row, *sensor, scale);
  if (!position) return std::nullopt;
  result.p_S = position->p_S;
  result.covariance_m2 = position->covariance_m2;
  return result;
}

}  // namespace

Read<MeasuredSweeps> read_measured_sweeps(const OpenRows& rows, const SignatureRecord& record) {
  MeasuredSweeps measured;
  const Signature& signature = record.signature;
  const calibration::ReadingModel readings = record.readings();
  const auto compare = [&](const MeasurementRow& row, const LocatedRow& found) {
    const auto* target = std::ranges::find(signature.targets, row.target, &Target::number);
    if (target == signature.targets.end()) return;
    const JointVector turned = calibration::true_readings(readings, signature.configuration, row.q);
    measured.compare(found, kinematics::target_position(signature, turned, *target));
  };
  const auto read =
      read_rows(rows, {.remembered = kRememberedInMemory},
                [&](const MeasurementRow& row, double scale) -> Read<void> {
                  if (const auto found = located(row, record.nominal, rows.sensor, scale)) {
                    measured.add(*found);
                    measured.rows_located.push_back({.line = row.line,
                                                     .sweep = row.sweep,
                                                     .target = row.target,
                                                     .q = row.q,
                                                     .p_S = found->p_S,
                                                     .covariance_m2 = found->covariance_m2});
                    compare(row, *found);
                  } else {
                    ++measured.not_located;
                  }
                  return {};
                });
  if (!read) return std::unexpected(read.error());
  measured.rows = read->rows;
  measured.match = match_of(record.origin, rows, *read);
  return measured;
}

}  // namespace armsig::tool
