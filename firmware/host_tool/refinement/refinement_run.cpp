// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/refinement_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/calibration/standing_still.hpp"
#include "core/identification.hpp"
#include "firmware/analysis/evaluation/geometry_alone.hpp"
#include "firmware/analysis/uncertainty/tool_covariance.hpp"
#include "firmware/host_tool/identification/nominal_fit.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/refinement/candidates.hpp"
#include "firmware/host_tool/refinement/refinement_words.hpp"
#include "firmware/library/estimate.hpp"

namespace armsig::tool {
namespace {

// Mixed poses that the sweeps speak against are blunders, unless most of them are.
constexpr double kContradictingShare = 0.5;
constexpr std::size_t kFewestMixed = 6;
// Radians or metres; zeros nearer to the drawing's are nothing to mention.
constexpr double kNotableShift = 0.05;
constexpr double kNotableVertical = 0.0175;  // rad
// Numbers beyond the unknowns from which a noise that nobody stated can be told at all.
constexpr std::size_t kToTellNoise = 3;
// A rejected row within so many times the RMS of those left out is predicted like any other.
constexpr double kLikeOthers = 3;
// Backlash of joints, as one angle: so many of them, and by which factor they differ at most.
constexpr std::size_t kFewestOfOneAngle = 4;
constexpr double kOneAngle = 1.1;

// The same angle in every joint that turns is what positions do that are late by one time.
bool is_one_angle(const calibration::HalfPlays& half_plays, const DhRows& joints) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  std::size_t certain = 0;
  for (std::size_t j = 0; j < half_plays.size(); ++j) {
    const calibration::HalfPlay& half = half_plays[j];
    if (joints[j].type != JointType::kRevolute || !std::isfinite(half.sigma)) continue;
    certain += is_certain(half) ? 1 : 0;
    least = std::min(least, half.value + 2 * half.sigma);
    most = std::max(most, half.value - 2 * half.sigma);
  }
  return certain >= kFewestOfOneAngle && least > 0 && most < kOneAngle * least;
}

bool any(const calibration::ReadingTerms& terms) {
  return terms.gain || terms.first || terms.second;
}

class Run {
 public:
  Run(const Arm& nominal, MeasurementLog& log, const std::optional<SensorDescription>& sensor,
      const std::string& file)
      : nominal_(nominal), log_(log), file_(file), verdicts_(log.observations().size()) {
    if (!sensor) return;
    for (const Vector3& p_S : sensor->receivers_S) receivers_.push_back(p_S);
  }

  [[nodiscard]] Read<RefinementOutcome> operator()(const std::optional<Signature>& start,
                                                   const FurtherUnknowns& further);

 private:
  [[nodiscard]] Read<void> place_targets(const std::optional<Signature>& start);
  [[nodiscard]] Read<void> fit(const std::optional<Signature>& start,
                               const FurtherUnknowns& further);
  [[nodiscard]] Read<void> check_counts(const std::optional<Signature>& start) const;
  void note_zeros(const JointVector& shifts);
  void note_gears(const calibration::Refined& refined);
  [[nodiscard]] std::vector<std::size_t> outlying_lines() const;
  void take_out_rejected(RefinementOutcome& outcome);
  [[nodiscard]] std::vector<std::size_t> still_joints() const;
  void name_open(RefinementOutcome& outcome) const;
  void note_play(const calibration::HalfPlays& half_plays);
  void note_vertical();
  [[nodiscard]] std::size_t unknowns() const;
  [[nodiscard]] std::optional<std::size_t> contradicting_mixed() const;
  [[nodiscard]] std::unexpected<Problem> refuse(const Refusal& refusal) const;
  [[nodiscard]] std::unexpected<Problem> refuse_start(const Refusal& refusal) const;
  [[nodiscard]] Read<void> mixed_agree() const;
  [[nodiscard]] std::unexpected<Problem> suspecting(Problem problem) const;
  [[nodiscard]] std::span<const Target> targets() const {
    return {targets_.data(), targets_.size()};
  }

  const Arm& nominal_;
  MeasurementLog& log_;
  const std::string& file_;
  calibration::Receivers receivers_;
  FixedVector<Target, kMaxTargets> targets_;
  std::vector<calibration::RowOutcome> verdicts_;
  std::optional<double> nominal_rms_m_;
  std::vector<std::string> notes_;
  Calibrated calibrated_;
};

// With the reading that seems to be to blame, where one is found.
std::unexpected<Problem> Run::suspecting(Problem problem) const {
  const auto suspicion = calibration::suspect_readings(nominal_, log_.positions(), targets());
  if (suspicion) {
    problem.what += "; " + in_words(*suspicion);
    problem.expected = remedy_for(*suspicion);
  }
  return std::unexpected(std::move(problem));
}

std::unexpected<Problem> Run::refuse(const Refusal& refusal) const {
  Problem problem = refinement_problem(refusal, file_);
  if (refusal.error == Error::kNotConverged || refusal.error == Error::kTooManyOutliers) {
    return suspecting(std::move(problem));
  }
  return std::unexpected(std::move(problem));
}

Read<void> Run::place_targets(const std::optional<Signature>& start) {
  if (start) {
    targets_ = start->targets;
  } else {
    const std::vector<Target> seen = log_.targets(nominal_.joints.size());
    if (seen.size() > kMaxTargets) {
      return std::unexpected(Problem{file_, 0, 0, fmt::format("{} targets", seen.size()),
                                     fmt::format("at most {}", kMaxTargets)});
    }
    for (const Target& target : seen) targets_.push_back(target);
  }
  if (const auto unknown = log_.index_targets(targets_)) {
    return std::unexpected(
        Problem{file_, 0, 0, fmt::format("target {} is in no sweep that gave a feature", *unknown),
                "a sweep of each target, or targets on the last link"});
  }
  return {};
}

std::optional<std::size_t> Run::contradicting_mixed() const {
  std::size_t mixed = 0;
  std::size_t rejected = 0;
  const auto& rows = log_.observations();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].sweep != 0) continue;
    ++mixed;
    if (verdicts_[k].rejected) ++rejected;
  }
  const bool most =
      static_cast<double>(rejected) > kContradictingShare * static_cast<double>(mixed);
  return mixed >= kFewestMixed && most ? std::optional(rejected) : std::nullopt;
}

std::size_t Run::unknowns() const {
  std::size_t unknowns = 3 * targets_.size();
  for (const DhJoint& joint : nominal_.joints) {
    unknowns += joint.type == JointType::kRevolute ? 4 : 2;
  }
  return unknowns;
}

void Run::note_zeros(const JointVector& shifts) {
  for (std::size_t j = 0; j < shifts.size(); ++j) {
    if (std::abs(shifts[j]) < kNotableShift) continue;
    notes_.push_back(fmt::format("joint {}: its zero is about {} from the nominal model's", j + 1,
                                 reading_in_words(nominal_.joints[j].type, shifts[j])));
  }
}

void Run::note_gears(const calibration::Refined& refined) {
  for (std::size_t j = 0; j < refined.readings.corrections.size(); ++j) {
    if (!is_off_by_its_gear(refined, j)) continue;
    const double gain = refined.readings.corrections[j].gain;
    const bool slides = nominal_.joints[j].type == JointType::kPrismatic;
    notes_.push_back(fmt::format(
        "joint {}: its reading is {:.4f} times what it moves, which the signature "
        "corrects; look at the {}",
        j + 1, 1 / (1 + gain),
        slides ? "lead, or at the sensor's scale along it, as no row tells which" : "gear ratio"));
  }
}

// A degree or less may be the base's, which stands as it was bolted down.
void Run::note_vertical() {
  if (!calibrated_.deflections || calibrated_.deflections->gravity.empty()) return;
  const Vector3& up_0 = calibrated_.deflections->up_0;
  const double off = std::atan2(up_0.cross(nominal_.up_0).norm(), up_0.dot(nominal_.up_0));
  if (off < kNotableVertical) return;
  notes_.push_back(fmt::format(
      "gravity pulls {:.1f}° from where the arm description has it; write there \"mounted: "
      "{{gravity: [{:.3f}, {:.3f}, {:.3f}]}}\"",
      degrees(off), -up_0.x(), -up_0.y(), -up_0.z()));
}

void Run::note_play(const calibration::HalfPlays& half_plays) {
  std::string words;
  for (std::size_t j = 0; j < half_plays.size(); ++j) {
    if (!is_certain(half_plays[j])) continue;
    const bool turns = nominal_.joints[j].type == JointType::kRevolute;
    const double unit = turns ? degrees(2) : 2e3;
    words += fmt::format("{}joint {}: {:.4f} ± {:.4f}{}", words.empty() ? "" : ", ", j + 1,
                         unit * std::abs(half_plays[j].value), unit * half_plays[j].sigma,
                         turns ? "°" : " mm");
  }
  if (words.empty()) return;
  words +=
      " of backlash, by the order of the rows: the signature is the arm in the middle of it, "
      "and half of it is part of what is stated";
  if (is_one_angle(half_plays, nominal_.joints)) {
    words += "; positions that are late behind the joint readings look the same";
  }
  notes_.push_back(std::move(words));
}

// More numbers than unknowns, and some to tell the noise by.
Read<void> Run::check_counts(const std::optional<Signature>& start) const {
  const auto& rows = log_.observations();
  std::size_t numbers = 0;
  bool stated = true;
  for (const auto& row : rows) {
    numbers += row.kind == calibration::ObservationKind::kPosition ? 3 : 1;
    stated = stated && row.sigma_m > 0;
  }
  const std::size_t least = unknowns();
  const bool positions = log_.positions_only();
  const std::size_t needed = least + (stated || numbers < least || !positions ? 0 : kToTellNoise);
  if (numbers < needed && (positions || !start)) {
    return refuse(
        Refusal{Error::kTooFewPoints, static_cast<double>(numbers), static_cast<double>(needed)});
  }
  return {};
}

Read<void> Run::fit(const std::optional<Signature>& start, const FurtherUnknowns& further) {
  if (const auto counted = check_counts(start); !counted) return counted;
  calibration::ParameterRequest request;
  request.receiver_offsets = further.receiver_offsets;
  request.scale = further.scale;
  if (any(further.readings)) request.readings.resize(nominal_.joints.size(), further.readings);
  auto done = run_calibration({.nominal = nominal_,
                               .start = start,
                               .rows = log_.observations(),
                               .positions = log_.positions(),
                               .targets = targets(),
                               .receivers = receivers_,
                               .request = request,
                               .choose_readings = further.choose_readings,
                               .as_read = further.as_read},
                              verdicts_);
  if (!done) return start ? refuse(done.error()) : refuse_start(done.error());
  calibrated_ = std::move(*done);
  note_zeros(calibrated_.zero_shifts);
  note_gears(*calibrated_.refined);
  note_play(calibrated_.half_plays);
  note_vertical();
  if (start) return mixed_agree();
  // Over every row but the outliers: the start's own figure leaves out whatever it weighs little.
  if (!calibrated_.drawn) return {};
  const auto drawn = nominal_residuals(nominal_, *calibrated_.drawn, log_.observations(), targets(),
                                       receivers_, verdicts_);
  if (drawn) nominal_rms_m_ = drawn->rms_m;
  return {};
}

Read<void> Run::mixed_agree() const {
  const auto contradicting = contradicting_mixed();
  if (!contradicting) return {};
  Problem problem{file_, 0, 0,
                  fmt::format("{} rows with sweep 0 contradict the sweeps", *contradicting),
                  "sweeps and poses of one arm, in one place, with rigid targets"};
  const auto& coupling = calibrated_.coupling;
  if (!coupling) return suspecting(std::move(problem));
  problem.what += "; " + in_words(*coupling) + ": " + evidence_in_words(*coupling);
  problem.expected = remedy_for(*coupling);
  return std::unexpected(std::move(problem));
}

// What the base lacks is counted in rows, what the unknowns lack in numbers.
std::unexpected<Problem> Run::refuse_start(const Refusal& refusal) const {
  if (refusal.error != Error::kTooFewPoints || refusal.needed >= static_cast<double>(unknowns())) {
    return refuse(refusal);
  }
  return std::unexpected(
      Problem{file_, 0, 0,
              fmt::format("{:.0f} positions of a target on the last link to find the base from",
                          refusal.found),
              receivers_.empty()
                  ? "rows of a target on the last link, at four poses or more"
                  : "rows in which three receivers or more heard it, at four poses or more"});
}

// A model that errs elsewhere fits the rows of sweeps closely, and by their scatter rejects good
// poses. What a fit without them predicts like other poses is no evidence against the arm.
std::vector<std::size_t> Run::outlying_lines() const {
  std::vector<calibration::RowOutcome> outlying = verdicts_;
  const double most_m = calibrated_.left_out ? kLikeOthers * calibrated_.left_out->rms_kept_m : 0;
  for (std::size_t k = 0; k < outlying.size() && most_m > 0; ++k) {
    const auto left_out_m = static_cast<double>(calibrated_.left_out_m[k]);
    if (left_out_m > 0 && left_out_m <= most_m) outlying[k].rejected = false;
  }
  return log_.rejected_lines(outlying);
}

// Rows that were rejected have no part in what follows.
void Run::take_out_rejected(RefinementOutcome& outcome) {
  auto& rows = log_.observations();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!outcome.half_plays.empty()) {
      outcome.moved_by_play[log_.line(k)] = calibrated_.moved_by_play[k];
    }
    if (!verdicts_[k].rejected) continue;
    rows[k].use = calibration::RowUse::kIgnore;
    outcome.free_poses_rejected += rows[k].sweep == 0;
  }
}

// From 0. As the engine has it (engine_still.cpp): by effective readings, below the row's target. A
// joint that no target is beyond may have moved.
std::vector<std::size_t> Run::still_joints() const {
  std::array<calibration::ReadingSpan, kMaxJoints> spans;
  std::size_t last = 0;
  for (const calibration::Observation& row : log_.observations()) {
    const JointVector effective = effective_readings(nominal_.couplings, row.readings);
    const std::size_t link = calibrated_.refined->signature.targets[row.target].link;
    for (std::size_t joint = 0; joint < link; ++joint) spans[joint].add(effective[joint]);
    last = std::max(last, link);
  }
  std::vector<std::size_t> still;
  for (std::size_t joint = 0; joint < last; ++joint) {
    if (spans[joint].is_jitter(nominal_.joints[joint].type)) still.push_back(joint);
  }
  return still;
}

void Run::name_open(RefinementOutcome& outcome) const {
  const calibration::Refined& refined = *calibrated_.refined;
  const std::vector<std::size_t> still = still_joints();
  if (!still.empty()) outcome.undetermined.push_back(still_in_words(still));
  for (const calibration::Undetermined& open : refined.undetermined) {
    const bool of_joint =
        open.open != calibration::Open::kTarget && open.open != calibration::Open::kReceiverOffset;
    if (of_joint && std::ranges::find(still, open.index) != still.end()) continue;
    outcome.undetermined.push_back(in_words(open, refined.signature));
  }
  for (const std::size_t t : calibrated_.alone) {
    outcome.undetermined.push_back(
        fmt::format("target {}: a single row sees it, and nothing checks that row",
                    refined.signature.targets[t].number));
  }
}

Read<RefinementOutcome> Run::operator()(const std::optional<Signature>& start,
                                        const FurtherUnknowns& further) {
  if (auto placed = place_targets(start); !placed) return std::unexpected(placed.error());
  if (auto fitted = fit(start, further); !fitted) return std::unexpected(fitted.error());
  calibration::Refined& refined = *calibrated_.refined;
  derive_parameters(refined.signature, nominal_);

  RefinementOutcome outcome{.refined = nullptr,
                            .fitted = calibrated_.request,
                            .rejected_lines = log_.rejected_lines(verdicts_),
                            .outlying_lines = outlying_lines(),
                            .free_poses_rejected = 0,
                            .undetermined = {},
                            .cross_validation = {},
                            .left_out = calibrated_.left_out,
                            .noise = calibrated_.noise,
                            .deflections = calibrated_.deflections,
                            .geometry_left_out_mean_m = {},
                            .offered = calibrated_.offered,
                            .coupling = calibrated_.coupling,
                            .tried = calibrated_.tried,
                            .half_plays = calibrated_.half_plays,
                            .moved_by_play = {},
                            .merged_rows = calibrated_.merged_rows,
                            .nominal_rms_m = nominal_rms_m_,
                            .notes = notes_,
                            .predicted_tool_error = {},
                            .predicted_over_limits_m = {}};
  take_out_rejected(outcome);
  name_open(outcome);
  if (calibrated_.deflections) outcome.geometry_left_out_mean_m = calibrated_.geometry->mean_m;
  if (const auto& score = calibrated_.left_out) {
    outcome.cross_validation =
        CrossValidation{score->rows, score->mean_m, score->rms_m, score->largest_m};
  }
  outcome.refined = std::move(calibrated_.refined);
  predict_tool_error(nominal_, outcome);
  return outcome;
}

}  // namespace

void predict_tool_error(const Arm& nominal, RefinementOutcome& outcome) {
  const calibration::Refined& refined = *outcome.refined;
  const auto tool = tool_target(refined.signature);
  if (!tool) return;
  const double over_limits_m = uncertainty::predicted_rms(refined, nominal.limits, *tool);
  outcome.predicted_tool_error = {over_limits_m, PredictedRegion::kJointLimits};
  if (!outcome.deflections) return;  // a map says nothing of readings that were not measured
  outcome.predicted_over_limits_m = over_limits_m;
  const auto covered = calibration::covered_limits(*outcome.deflections, nominal.limits);
  outcome.predicted_tool_error = {uncertainty::predicted_rms(refined, covered, *tool),
                                  PredictedRegion::kMeasuredReadings};
}

Read<RefinementOutcome> run_refinement(const Arm& nominal, const std::optional<Signature>& start,
                                       MeasurementLog& log,
                                       const std::optional<SensorDescription>& sensor,
                                       const FurtherUnknowns& further, const std::string& file) {
  return Run(nominal, log, sensor, file)(start, further);
}

}  // namespace armsig::tool
