// SPDX-License-Identifier: MIT
#include "firmware/host_tool/identification_run.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "core/kinematics/s_model_chain.hpp"
#include "core/measurement/speed_of_sound.hpp"
#include "core/measurement/trilateration.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {

measurement::ReceiverArray receivers_of(const SensorDescription& sensor) {
  measurement::ReceiverArray array;
  for (const Vector3& p_S : sensor.receivers_S) array.p_S.push_back(p_S);
  array.range_sigma_m = sensor.range_sigma_m;
  array.facing_S = sensor.facing_S.value_or(Vector3::Zero());
  return array;
}

IdentificationRun::IdentificationRun(const Arm& nominal, std::optional<SensorDescription> sensor,
                                     std::string file, KeepLog keep_log)
    : nominal_(nominal),
      sensor_(std::move(sensor)),
      file_(file),
      sweeps_(nominal, std::move(file)) {
  if (keep_log == KeepLog::kYes) log_.emplace();
}

Read<void> IdentificationRun::take(const MeasurementRow& row) {
  ++counts_.rows;
  if (row.air_c) {
    air_sum_c_ += *row.air_c;
    ++air_count_;
  }
  if (log_) {
    const auto scale = range_scale(row);
    if (!scale) return std::unexpected(scale.error());
    log_->add(row, sensor_, *scale);
  }
  auto found = located(row);
  if (!found) return std::unexpected(found.error());
  if (!*found) return {};
  if (auto problem = sweeps_.add(**found)) return std::unexpected(*problem);
  return {};
}

Read<std::optional<LocatedRow>> IdentificationRun::located(const MeasurementRow& row) {
  LocatedRow result;
  result.line = row.line;
  result.sweep = row.sweep;
  result.target = row.target;
  result.q = effective_readings(nominal_, row.q);
  if (!row.ranges_m.empty()) return located_by_ranges(row, result);
  if (!row.p_S) {
    ++counts_.missing;
    return std::nullopt;
  }
  result.p_S = *row.p_S;
  if (row.sigma_m) result.covariance_m2 = Matrix3::Identity() * (*row.sigma_m * *row.sigma_m);
  return result;
}

Read<std::optional<LocatedRow>> IdentificationRun::located_by_ranges(const MeasurementRow& row,
                                                                     LocatedRow result) {
  const auto line = static_cast<int>(row.line);
  if (!sensor_) {
    return std::unexpected(Problem{file_, line, 0, "the rows are ranges to receivers",
                                   "--sensor with a description of where the receivers stand"});
  }
  if (row.ranges_m.size() != sensor_->receivers_S.size()) {
    return std::unexpected(
        Problem{file_, line, 0, fmt::format("ranges to {} receivers", row.ranges_m.size()),
                fmt::format("{}, as the sensor description has", sensor_->receivers_S.size())});
  }
  const auto scale = range_scale(row);
  if (!scale) return std::unexpected(scale.error());
  measurement::Ranges ranges;
  for (const std::optional<double>& range_m : row.ranges_m) {
    ranges.push_back({.metres = *scale * range_m.value_or(0), .valid = range_m.has_value()});
  }
  const auto position = measurement::trilaterate(receivers_of(*sensor_), ranges);
  if (!position) {
    ++(position.error() == Error::kTooFewReceivers ? counts_.missing : counts_.inconsistent);
    return std::nullopt;
  }
  counts_.excluded_ranges += position->excluded.size();
  result.p_S = position->p_S;
  result.covariance_m2 = position->covariance_m2;
  return result;
}

// What the ranges of a row are to be multiplied by: the speed of sound of its air over that they
// were computed with.
Read<double> IdentificationRun::range_scale(const MeasurementRow& row) const {
  if (row.ranges_m.empty() || !sensor_ || !sensor_->calibrated_at_c) return 1.0;
  const auto line = static_cast<int>(row.line);
  if (!row.air_c) {
    return std::unexpected(Problem{file_, line, 0, "no air temperature",
                                   "a column air_c: the sensor's ranges depend on it"});
  }
  const auto speed = measurement::speed_of_sound(*row.air_c);
  const auto assumed = measurement::speed_of_sound(*sensor_->calibrated_at_c);
  if (!speed || !assumed) {
    return std::unexpected(Problem{file_, line, 0,
                                   fmt::format("an air temperature of {} °C", *row.air_c),
                                   "an air temperature in degrees Celsius"});
  }
  return *speed / *assumed;
}

Problem IdentificationRun::mirrored(const IdentificationFailure& failure) const {
  std::string what;
  if (failure.sense.verdict == frames::SenseVerdict::kSensorMirrored) {
    what = "the measured arm is the mirror image of the arm description";
  } else {
    std::string joints;
    for (std::size_t j = 0; j < failure.sense.reversed.size(); ++j) {
      if (failure.sense.reversed[j])
        joints += fmt::format("{}{}", joints.empty() ? "" : ", ", j + 1);
    }
    what = fmt::format(
        "joint {} turns against the sense of the arm description (an axis is {:.0f}° "
        "from where the drawing has it)",
        joints, degrees(failure.refusal.found));
  }
  return {file_, 0, 0, what, remedy_in_words(Error::kMirroredSense)};
}

Read<Signature> IdentificationRun::signature_from(const SweptArm& swept) const {
  auto signature = identify(swept.features, swept.configuration, nominal_);
  if (!signature) {
    const IdentificationFailure& failure = signature.error();
    if (failure.refusal.error == Error::kMirroredSense) return std::unexpected(mirrored(failure));
    return std::unexpected(
        Problem{file_, 0, 0,
                fmt::format("joint {}: {}", failure.joint + 1, describe(failure.refusal.error)),
                remedy_in_words(failure.refusal.error)});
  }
  signature->targets = swept.targets;
  return *signature;
}

Read<Identified> IdentificationRun::finish(features::Method method) const {
  auto swept = sweeps_.finish(method);
  if (!swept) return std::unexpected(swept.error());
  const auto signature = signature_from(*swept);
  if (!signature) return std::unexpected(signature.error());
  Identified identified{
      .signature = *signature, .counts = counts_, .air_celsius = {}, .warnings = {}};
  identified.counts.mixed = sweeps_.mixed_rows();
  if (air_count_ > 0) identified.air_celsius = air_sum_c_ / static_cast<double>(air_count_);
  if (!signature->description_matches) {
    identified.warnings.emplace_back(
        "the axes found do not match those of the arm description: another arm, a joint that turns "
        "the other way, or zeros far from the drawing's");
  }
  return identified;
}

// A target that mixed poses show is on the last link; where no sweep follows it, the first of those
// poses says where.
void IdentificationRun::add_targets_of_mixed_poses(Signature& signature) const {
  const std::size_t n = signature.joint_count();
  for (const Target& seen : log_->targets(n)) {
    auto* known = std::ranges::find(signature.targets, seen.number, &Target::number);
    if (known != signature.targets.end()) {
      known->link = seen.link;
      continue;
    }
    const refinement::Observation* first = log_->first_position(seen.number);
    if (first == nullptr || signature.targets.full()) continue;
    const JointVector q = effective_readings(nominal_, first->readings);
    Target target = seen;
    target.p_S =
        signature.X_SL[n] * (kinematics::link_pose(signature, q, n).inverse() * first->p_S);
    signature.targets.push_back(target);
  }
}

Read<std::pair<Identified, RefinementOutcome>> IdentificationRun::finish_refined() {
  Identified identified{.signature = {}, .counts = counts_, .air_celsius = {}, .warnings = {}};
  std::optional<Signature> start;
  if (const auto swept = sweeps_.finish(features::Method::kEncoder)) {
    auto signature = signature_from(*swept);
    if (!signature) return std::unexpected(signature.error());
    add_targets_of_mixed_poses(*signature);
    start = *signature;
  } else if (counts_.rows > sweeps_.mixed_rows()) {
    identified.warnings.push_back(swept.error().what +
                                  "; started from the arm description instead of from features");
  }
  auto outcome = run_refinement(nominal_, start, *log_, sensor_, file_);
  if (!outcome) return std::unexpected(outcome.error());
  identified.signature = outcome->refined->signature;
  if (air_count_ > 0) identified.air_celsius = air_sum_c_ / static_cast<double>(air_count_);
  for (const std::string& open : outcome->undetermined) identified.warnings.push_back(open);
  return std::pair(std::move(identified), std::move(*outcome));
}

}  // namespace armsig::tool
