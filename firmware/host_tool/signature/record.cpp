// SPDX-License-Identifier: MIT
#include "firmware/host_tool/signature/record.hpp"

#include <cmath>
#include <ctime>
#include <memory>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "firmware/analysis/uncertainty/feature_information.hpp"
#include "firmware/analysis/uncertainty/tool_covariance.hpp"
#include "firmware/host_tool/identification/missed_sweeps.hpp"
#include "firmware/host_tool/identification/unused_poses.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/sweeps_alone/unseen_bending.hpp"
#include "firmware/library/estimate.hpp"

namespace armsig::tool {
namespace {

std::string now_utc() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

// Errors larger by this than what is predicted are worth a word.
constexpr double kNotable = 2;

double square(double x) { return x * x; }

void add_covariance(SignatureRecord& record, const calibration::Refined& refined) {
  record.covariance = covariance_of(refined);
  record.covariance_of =
      "axis lines in their link frames (direction x, y; position x, y of a revolute joint), each "
      "followed by what was fitted of its reading_correction, joint by joint; then target points, "
      "range offsets, length scale, as far as fitted; rad and m";
}

std::optional<FitRecord::LeftOut> left_out(const std::optional<CrossValidation>& validation) {
  if (!validation || validation->rows == 0) return std::nullopt;
  return FitRecord::LeftOut{validation->rows, validation->mean_m, validation->rms_m};
}

// Every sigma of the estimate and of the targets, times `factor`.
void enlarge(SignatureRecord& record, calibration::Refined& estimate, double factor) {
  estimate.information.scale(1 / factor);
  for (Target& target : estimate.signature.targets) target.covariance_m2 *= square(factor);
  for (Target& target : record.signature.targets) target.covariance_m2 *= square(factor);
}

void enlarge_maps(RefinementOutcome& outcome, double factor) {
  if (!outcome.deflections) return;
  auto wider = std::make_shared<calibration::ArmModel>(*outcome.deflections);
  for (calibration::JointModel& joint : wider->joints) {
    for (float& variance : joint.map_variance) variance *= static_cast<float>(square(factor));
  }
  outcome.refined->readings.deflections = wider.get();
  outcome.deflections = std::move(wider);
}

// How many times more than the features say is to be stated, and the reason where that is notable.
struct Enlargement {
  double factor = 1;
  std::string why;
};

// The errors of the parameters are the same in all poses: those measured say what they come to.
Enlargement by_unused_poses(const Evidence& evidence, const calibration::Refined& estimate) {
  const auto unused = judge_unused_poses(evidence, estimate);
  if (!unused || unused->missed_m < kComputed_m) return {};
  const double factor = unused->missed_m / unused->predicted_m;
  return {
      factor,
      fmt::format("{} poses that this method does not use are missed by {:.3f} mm, {:.1f} times "
                  "what the features predict, and so much more is stated; --method refined "
                  "uses them",
                  unused->count, 1e3 * unused->missed_m, factor)};
}

// What misses in the sweeps is elsewhere at most so many times as large: twice where the sensor was
// moved for two of six sweeps, four to five times where a gear is 0.1 % off.
constexpr double kElsewhere = 4;

// Nor do the features know of each other: each follows its own sweep.
Enlargement by_missed_sweeps(const Evidence& evidence, const calibration::Refined& estimate,
                             const Arm& nominal, std::size_t tool) {
  const auto sweeps = judge_missed_sweeps(evidence, estimate);
  if (!sweeps || sweeps->missed_m < kComputed_m) return {};
  const double stated_m = uncertainty::predicted_rms(estimate, nominal.limits, tool);
  const double factor = std::min(sweeps->missed_m / sweeps->predicted_m,
                                 std::hypot(1, kElsewhere * sweeps->missed_m / stated_m));
  return {factor,
          fmt::format("the sweeps contradict each other: the arm found misses their points by "
                      "{:.3f} mm beyond the noise, and {:.1f} times what the features predict is "
                      "stated; gravity, joint errors, or a sensor or target moved between two "
                      "sweeps: further poses (sweep 0) and --method refined tell",
                      1e3 * sweeps->missed_m, factor)};
}

// Sweeps do not tell what bends, what is tilted and what a gear does apart: so much more is stated.
Enlargement by_bending(const Evidence& evidence, const calibration::Refined& estimate,
                       const Arm& nominal, std::size_t tool, bool by_features) {
  const auto bending = judge_bending(evidence, estimate, nominal.limits, tool, !by_features);
  if (!bending || bending->expected_m < kComputed_m) return {};
  return {bending->factor,
          fmt::format(
              "the sweeps show that the arm deflects or a gear ratio is off, and not which: at the "
              "tool {:.3f} mm are stated, {:.1f} times what {} predict{}; further poses "
              "(sweep 0){} tell",
              1e3 * bending->expected_m, bending->expected_m / bending->stated_m,
              by_features ? "the axes alone" : "the fit", by_features ? "" : "s",
              by_features ? " and --method refined" : "")};
}

// The largest: each tells of the same parameters.
Enlargement enlargement_of(const Evidence& evidence, const calibration::Refined& estimate,
                           const Arm& nominal, std::optional<std::size_t> tool) {
  Enlargement most;
  const auto consider = [&](Enlargement one) {
    if (one.factor > most.factor) most = std::move(one);
  };
  consider(by_unused_poses(evidence, estimate));
  if (!tool) return most;
  consider(by_missed_sweeps(evidence, estimate, nominal, *tool));
  consider(by_bending(evidence, estimate, nominal, *tool, true));
  return most;
}

}  // namespace

SignatureRecord record_of(const Identified& identified, const ArmDescription& arm,
                          const std::string& method, const std::string& serial) {
  SignatureRecord record;
  record.signature = identified.signature;
  record.arm_name = arm.name;
  record.joint_names = arm.joint_names;
  record.serial = serial;
  record.method = method;
  record.nominal = arm.arm;
  record.mounting = arm.mounting;
  record.air_c = identified.air_celsius;
  record.time = now_utc();
  record.version = ARMSIG_VERSION;
  record.warnings = identified.warnings;
  return record;
}

double add_refinement(SignatureRecord& record, RefinementOutcome& outcome, std::size_t receivers,
                      const Evidence& evidence) {
  calibration::Refined& refined = *outcome.refined;
  Enlargement more;
  if (const auto tool = tool_target(refined.signature)) {
    more = by_bending(evidence, refined, record.nominal, *tool, false);
  }
  if (more.factor > 1) {
    enlarge(record, refined, more.factor);
    enlarge_maps(outcome, more.factor);
    predict_tool_error(record.nominal, outcome);
  }
  add_covariance(record, refined);
  record.sigma_m = refined.quality.sigma_m;
  record.unexplained_m = refined.quality.unexplained_m;
  record.noise_freedom = refined.quality.noise_freedom;
  record.accuracy.predicted = outcome.predicted_tool_error;
  record.fitted = outcome.fitted;
  record.deflections = outcome.deflections;
  if (!outcome.fitted.readings.empty()) record.corrections = refined.readings.corrections;
  for (std::size_t k = 0; outcome.fitted.receiver_offsets && k < receivers; ++k) {
    record.receiver_offsets_m.push_back(refined.receiver_offsets_m[k]);
  }
  record.scale = refined.scale;
  record.fit =
      FitRecord{refined.quality.rows_used, refined.quality.rows_rejected, refined.quality.rms_m,
                left_out(outcome.cross_validation), outcome.merged_rows.value_or(0)};
  if (more.factor >= kNotable) record.warnings.push_back(more.why);
  return more.factor;
}

double add_features(SignatureRecord& record, const std::optional<CrossValidation>& validation,
                    const Evidence& evidence) {
  const Signature& signature = record.signature;
  FitRecord fit;
  double variance = 0;
  double squares = 0;
  for (const features::JointFeature& feature : signature.features) {
    const features::SweepQuality& quality = feature.quality;
    fit.rows_used += quality.used;
    fit.rows_rejected += quality.rejected;
    squares += static_cast<double>(quality.used) *
               (square(quality.rms_normal_m) + square(quality.rms_radial_m) +
                square(quality.rms_tangential_m));
    variance += square(quality.sigma_m) / static_cast<double>(signature.joint_count());
  }
  if (fit.rows_used > 0) fit.rms_m = std::sqrt(squares / static_cast<double>(fit.rows_used));
  fit.left_out = left_out(validation);
  record.fit = fit;
  record.sigma_m = std::sqrt(variance);
  const auto estimate = std::make_unique<calibration::Refined>();
  if (!uncertainty::from_features(signature, *estimate)) return 1;
  estimate->readings = record.readings();
  const auto tool = tool_target(signature);
  const Enlargement more = enlargement_of(evidence, *estimate, record.nominal, tool);
  if (more.factor > 1) enlarge(record, *estimate, more.factor);
  if (more.factor >= kNotable) record.warnings.push_back(more.why);
  add_covariance(record, *estimate);
  if (tool) {
    record.accuracy.predicted = {
        uncertainty::predicted_rms(*estimate, record.nominal.limits, *tool),
        PredictedRegion::kJointLimits};
  }
  return more.factor;
}

SignatureRecord exact_record(const Signature& signature, const ArmDescription& arm) {
  SignatureRecord record;
  record.signature = signature;
  record.arm_name = arm.name;
  record.joint_names = arm.joint_names;
  record.method = "exact";
  record.nominal = arm.arm;
  record.mounting = arm.mounting;
  record.time = now_utc();
  record.version = ARMSIG_VERSION;
  return record;
}

}  // namespace armsig::tool
