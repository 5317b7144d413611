// SPDX-License-Identifier: MIT
#include "firmware/host_tool/identification/identification_run.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "core/kinematics/s_model_chain.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/reading/ranging.hpp"

namespace armsig::tool {

IdentificationRun::IdentificationRun(const Arm& nominal, std::optional<SensorDescription> sensor,
                                     std::string file, features::Method method, Purpose purpose)
    : nominal_(nominal),
      sensor_(std::move(sensor)),
      file_(file),
      sweeps_(nominal, std::move(file), method, purpose == Purpose::kRefinement) {
  if (purpose == Purpose::kRefinement) log_.emplace();
  if (purpose == Purpose::kValidatedFeatures) validation_.emplace(nominal_, file_, method);
}

Read<void> IdentificationRun::take(const MeasurementRow& row) {
  ++counts_.rows;
  if (row.air_c) {
    air_sum_c_ += *row.air_c;
    ++air_count_;
  }
  const auto scale = range_scale(row, sensor_, file_);
  if (!scale) return std::unexpected(scale.error());
  if (log_) log_->add(row, sensor_, *scale);
  const std::optional<LocatedRow> found = located(row, *scale, counts_);
  if (!found) return {};
  if (log_ && !row.ranges_m.empty()) log_->add_located(found->p_S);
  if (auto problem = sweeps_.add(*found)) return std::unexpected(*problem);
  if (validation_) validation_->learn(*found);
  return {};
}

std::optional<LocatedRow> IdentificationRun::located(const MeasurementRow& row, double scale,
                                                     RowCounts& counts) const {
  LocatedRow result;
  result.line = row.line;
  result.sweep = row.sweep;
  result.target = row.target;
  result.q = effective_readings(nominal_, row.q);
  if (!row.ranges_m.empty()) {
    const auto position = locate(row, *sensor_, scale);
    if (!position) {
      ++(position.error() == Error::kTooFewReceivers ? counts.missing : counts.inconsistent);
      return std::nullopt;
    }
    counts.excluded_ranges += position->excluded.size();
    result.p_S = position->p_S;
    result.covariance_m2 = position->covariance_m2;
    return result;
  }
  if (!row.p_S) {
    ++counts.missing;
    return std::nullopt;
  }
  result.p_S = *row.p_S;
  if (row.sigma_m) result.covariance_m2 = Matrix3::Identity() * (*row.sigma_m * *row.sigma_m);
  return result;
}

bool IdentificationRun::settle_validation() {
  return validation_->settle([this](const SweptArm& swept) -> std::optional<Signature> {
    auto signature = signature_from(swept);
    if (!signature) return std::nullopt;
    return *std::move(signature);
  });
}

void IdentificationRun::score(const MeasurementRow& row) {
  RowCounts ignored;
  const auto scale = range_scale(row, sensor_, file_);
  const auto found = scale ? located(row, *scale, ignored) : std::nullopt;
  if (found) validation_->score(*found);
}

Problem IdentificationRun::mirrored(const IdentificationFailure& failure) const {
  std::string what;
  if (failure.sense.verdict == frames::SenseVerdict::kSensorMirrored) {
    what = "the measured arm is the mirror image of the arm description";
  } else {
    std::vector<std::string> joints;
    for (std::size_t j = 0; j < failure.sense.reversed.size(); ++j) {
      if (failure.sense.reversed[j]) joints.push_back(std::to_string(j + 1));
    }
    what = fmt::format(
        "{} against the sense of the arm description (an axis is {:.0f}° "
        "from where the nominal model has it)",
        joints.size() == 1 ? fmt::format("joint {} turns", joints[0])
                           : fmt::format("joints {} turn", all_of(joints)),
        degrees(failure.refusal.found));
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

namespace {

void warn_of_targets_next_to_axes(const Signature& signature, std::vector<std::string>& warnings) {
  for (std::size_t j = 0; j < signature.features.size(); ++j) {
    const features::JointFeature& feature = signature.features[j];
    if (feature.type == JointType::kPrismatic || feature.radius_m > features::kNextToAxis_m) {
      continue;
    }
    warnings.push_back(fmt::format(
        "joint {}: its target is {:.1f} mm from its axis, and tells its direction badly; one 200 "
        "mm away tells it better",
        j + 1, 1e3 * feature.radius_m));
  }
}

}  // namespace

Read<Identified> IdentificationRun::finish() const {
  auto swept = sweeps_.finish();
  if (!swept) return std::unexpected(swept.error());
  const auto signature = signature_from(*swept);
  if (!signature) return std::unexpected(signature.error());
  Identified identified{
      .signature = *signature, .counts = counts_, .air_celsius = {}, .warnings = {}};
  identified.counts.mixed = sweeps_.mixed_rows();
  if (air_count_ > 0) identified.air_celsius = air_sum_c_ / static_cast<double>(air_count_);
  identified.warnings = sweeps_.doubtful_targets();
  warn_of_targets_next_to_axes(*signature, identified.warnings);
  if (!signature->description_matches) {
    identified.warnings.emplace_back(
        "the axes found do not match those of the arm description: another arm, a joint that turns "
        "the other way, or zeros far from the nominal model's");
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
    const calibration::Observation* first = log_->first_position(seen.number);
    if (first == nullptr || signature.targets.full()) continue;
    const JointVector q = effective_readings(nominal_, first->readings);
    Target target = seen;
    target.p_S =
        signature.X_SL[n] * (kinematics::link_pose(signature, q, n).inverse() * first->p_S);
    signature.targets.push_back(target);
  }
}

Read<std::pair<Identified, RefinementOutcome>> IdentificationRun::finish_refined(
    const FurtherUnknowns& further) {
  Identified identified{.signature = {}, .counts = counts_, .air_celsius = {}, .warnings = {}};
  identified.warnings = sweeps_.doubtful_targets();
  std::optional<Signature> start;
  if (const auto swept = sweeps_.finish()) {
    auto signature = signature_from(*swept);
    if (!signature) return std::unexpected(signature.error());
    // Poses anywhere tell the axes, too.
    if (sweeps_.mixed_rows() == 0) warn_of_targets_next_to_axes(*signature, identified.warnings);
    add_targets_of_mixed_poses(*signature);
    start = *signature;
  } else if (counts_.rows > sweeps_.mixed_rows()) {
    identified.warnings.push_back(swept.error().what +
                                  "; started from the arm description instead of from features");
  }
  auto outcome = run_refinement(nominal_, start, *log_, sensor_, further, file_);
  if (!outcome) return std::unexpected(outcome.error());
  identified.signature = outcome->refined->signature;
  identified.counts.mixed = sweeps_.mixed_rows();
  if (air_count_ > 0) identified.air_celsius = air_sum_c_ / static_cast<double>(air_count_);
  for (const std::string& note : outcome->notes) identified.warnings.push_back(note);
  for (const std::string& open : outcome->undetermined) identified.warnings.push_back(open);
  return std::pair(std::move(identified), std::move(*outcome));
}

}  // namespace armsig::tool
