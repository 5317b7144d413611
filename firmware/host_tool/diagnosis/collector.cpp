// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/collector.hpp"

#include <cmath>

#include "firmware/host_tool/reading/ranging.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kRowsKept = 8192;

}  // namespace

EvidenceCollector::EvidenceCollector(const Arm& drawing, std::optional<SensorDescription> sensor)
    : sensor_(std::move(sensor)), types_(types_of(drawing.joints)), evidence_{drawing, {}, false} {}

void EvidenceCollector::add(const MeasurementRow& row) {
  phase_ = std::fmod(phase_ + kGoldenShare, 1.0);
  approach_.go_to(types_, row.q);
  EvidenceRow kept{.line = row.line,
                   .sweep = row.sweep,
                   .target = row.target,
                   .q = row.q,
                   .sides = approach_.sides(),
                   .sided = approach_.sided(),
                   .earlier = earlier_};
  if (row.p_S) {
    kept.p_S = *row.p_S;
    kept.covariance_m2 = std::pow(row.sigma_m.value_or(0), 2) * Matrix3::Identity();
  } else {
    if (row.ranges_m.empty() || !sensor_) return;
    const auto scale = range_scale(row, sensor_, "");
    if (!scale) return;
    const auto position = locate(row, *sensor_, *scale);
    if (!position) return;
    kept.p_S = position->p_S;
    evidence_.located = true;
    kept.covariance_m2 = position->covariance_m2;
  }
  earlier_ = {EarlierRow{row.sweep, row.target, row.q, kept.p_S}, earlier_[0]};
  if (thinning_ > 0 && phase_ >= std::ldexp(1.0, -static_cast<int>(thinning_))) return;
  evidence_.rows.push_back(kept);
  if (evidence_.rows.size() < kRowsKept) return;
  evidence_ = thinned(evidence_, kRowsKept / 2);
  ++thinning_;
}

}  // namespace armsig::tool
