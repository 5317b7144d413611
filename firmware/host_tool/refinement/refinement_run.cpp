// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/refinement_run.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/identification.hpp"
#include "core/uncertainty/tool_covariance.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/refinement/refinement_words.hpp"
#include "firmware/host_tool/signature/estimate.hpp"

namespace armsig::tool {
namespace {

// Mixed poses that the sweeps speak against are blunders, unless most of them are.
constexpr double kContradictingShare = 0.5;
constexpr std::size_t kFewestMixed = 6;
// Radians or metres; zeros nearer to the drawing's are nothing to mention.
constexpr double kNotableShift = 0.05;
// Corrections that nobody asked for are tried on logs up to this long: a second or two.
constexpr std::size_t kMostRowsToOffer = 1000;
// They are offered where they predict rows left out better by this much.
constexpr double kWorthOffering = 0.95;
// Numbers beyond the unknowns from which a noise that nobody stated can be told at all.
constexpr std::size_t kToTellNoise = 3;

bool any(const refinement::ReadingTerms& terms) {
  return terms.gain || terms.first || terms.second;
}

class Run {
 public:
  Run(const Arm& nominal, MeasurementLog& log, const std::optional<SensorDescription>& sensor,
      const std::string& file)
      : nominal_(nominal),
        log_(log),
        file_(file),
        verdicts_(log.observations().size()),
        refined_(std::make_unique<refinement::Refined>()) {
    config_.readings.couplings = nominal.couplings;
    if (!sensor) return;
    for (const Vector3& p_S : sensor->receivers_S) config_.receivers.push_back(p_S);
  }

  [[nodiscard]] Read<RefinementOutcome> operator()(const std::optional<Signature>& start,
                                                   const FurtherUnknowns& further);

 private:
  [[nodiscard]] Read<void> place_targets(const std::optional<Signature>& start);
  [[nodiscard]] Read<void> fit(const std::optional<Signature>& start);
  [[nodiscard]] Read<void> fit_positions(const std::optional<Signature>& start);
  [[nodiscard]] Read<void> check_counts(const std::optional<Signature>& start) const;
  [[nodiscard]] Read<void> fit_further(const FurtherUnknowns& further);
  void note_zeros(const JointVector& shifts);
  [[nodiscard]] std::size_t unknowns() const;
  [[nodiscard]] double predicted_where_measured(std::size_t tool) const;
  [[nodiscard]] std::expected<void, Refusal> refit(const Signature& start);
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
  refinement::RefinementConfig config_;
  FixedVector<Target, kMaxTargets> targets_;
  std::vector<refinement::RowOutcome> verdicts_;
  std::unique_ptr<refinement::Refined> refined_;
  std::optional<double> drawing_rms_m_;
  std::vector<std::string> zeros_;
  std::optional<Calibrated> calibrated_;
};

// With the reading that seems to be to blame, where one is found.
std::unexpected<Problem> Run::suspecting(Problem problem) const {
  const auto suspicion = refinement::suspect_readings(nominal_, log_.positions(), targets());
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
    zeros_.push_back(fmt::format("joint {}: its zero is about {} from the drawing's", j + 1,
                                 reading_in_words(nominal_.joints[j].type, shifts[j])));
  }
}

// More numbers than unknowns, and some to tell the noise by.
Read<void> Run::check_counts(const std::optional<Signature>& start) const {
  const auto& rows = log_.observations();
  std::size_t numbers = 0;
  bool stated = true;
  for (const auto& row : rows) {
    numbers += row.kind == refinement::ObservationKind::kPosition ? 3 : 1;
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

// Axes and targets alone.
Read<void> Run::fit(const std::optional<Signature>& start) {
  const auto& rows = log_.observations();
  if (const auto counted = check_counts(start); !counted) return counted;
  if (log_.positions_only()) return fit_positions(start);
  if (start) {
    const auto done = refinement::refine(*start, rows, config_, verdicts_, *refined_);
    if (!done) return refuse(done.error());
    return mixed_agree();
  }
  refinement::DrawingReport report;
  const auto done = refinement::refine_from_drawing(nominal_, rows, targets(), config_, verdicts_,
                                                    *refined_, {}, &report, log_.positions());
  if (!done) return refuse_start(done.error());
  drawing_rms_m_ = report.drawn_rms_m;
  note_zeros(report.zero_shifts);
  return {};
}

Read<void> Run::fit_positions(const std::optional<Signature>& start) {
  auto done = run_calibration({nominal_, start, log_.observations(), targets()}, verdicts_);
  if (!done) return start ? refuse(done.error()) : refuse_start(done.error());
  calibrated_ = std::move(*done);
  *refined_ = *calibrated_->refined;
  if (start) return mixed_agree();
  drawing_rms_m_ = calibrated_->drawing_rms_m;
  note_zeros(calibrated_->zero_shifts);
  return {};
}

Read<void> Run::mixed_agree() const {
  if (const auto contradicting = contradicting_mixed()) {
    return suspecting({file_, 0, 0,
                       fmt::format("{} rows with sweep 0 contradict the sweeps", *contradicting),
                       "sweeps and poses of one arm, in one place, with rigid targets"});
  }
  return {};
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
              config_.receivers.empty()
                  ? "rows of a target on the last link, at four poses or more"
                  : "rows in which three receivers or more heard it, at four poses or more"});
}

std::expected<void, Refusal> Run::refit(const Signature& start) {
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): `start` may be part of *refined_
  const Signature from = start;
  return refinement::refine(from, log_.observations(), config_, verdicts_, *refined_);
}

Read<void> Run::fit_further(const FurtherUnknowns& further) {
  const std::size_t n = nominal_.joints.size();
  calibrated_.reset();
  refined_->readings.deflections = nullptr;
  refinement::ReadingTerms terms = further.readings;
  config_.request.receiver_offsets = further.receiver_offsets;
  config_.request.scale = further.scale;
  if (further.choose_readings) {
    const auto scratch = std::make_unique<refinement::Refined>();
    refinement::CrossValidation best;
    const auto chosen = refinement::choose_reading_terms(refined_->signature, log_.observations(),
                                                         config_, verdicts_, *scratch, best);
    if (!chosen) return refuse(chosen.error());
    terms = *chosen;
  }
  if (any(terms)) config_.request.readings.resize(n, terms);
  const auto done = refit(refined_->signature);
  if (!done) return refuse(done.error());
  return {};
}

// Over the poses measured: elsewhere a map says nothing, and its prior everything.
double Run::predicted_where_measured(std::size_t tool) const {
  constexpr std::size_t kMostPoses = 300;
  const auto& rows = log_.observations();
  const std::size_t stride = 1 + rows.size() / kMostPoses;
  double sum = 0;
  double count = 0;
  for (std::size_t k = 0; k < rows.size(); k += stride) {
    if (verdicts_[k].rejected) continue;
    sum += uncertainty::tool_covariance(*refined_, rows[k].readings, tool).trace();
    count += 1;
  }
  return std::sqrt(sum / std::max(count, 1.0));
}

Read<RefinementOutcome> Run::operator()(const std::optional<Signature>& start,
                                        const FurtherUnknowns& further) {
  if (auto placed = place_targets(start); !placed) return std::unexpected(placed.error());
  if (auto fitted = fit(start); !fitted) return std::unexpected(fitted.error());
  const refinement::ReadingTerms& terms = further.readings;
  if (any(terms) || further.choose_readings || further.receiver_offsets || further.scale) {
    if (auto fitted = fit_further(further); !fitted) return std::unexpected(fitted.error());
  }
  derive_parameters(refined_->signature, nominal_);

  RefinementOutcome outcome{.refined = nullptr,
                            .fitted = config_.request,
                            .rejected_lines = log_.rejected_lines(verdicts_),
                            .undetermined = {},
                            .cross_validation = {},
                            .left_out = {},
                            .noise = {},
                            .deflections = {},
                            .geometry_left_out_mean_m = {},
                            .offered = {},
                            .drawing_rms_m = drawing_rms_m_,
                            .zeros = zeros_,
                            .predicted_tool_error_m = {}};
  auto& rows = log_.observations();
  for (std::size_t k = 0; k < verdicts_.size(); ++k) {
    if (verdicts_[k].rejected) rows[k].use = refinement::RowUse::kIgnore;
  }
  for (const refinement::Undetermined& open : refined_->undetermined) {
    outcome.undetermined.push_back(in_words(open, refined_->signature));
  }
  if (const auto tool = tool_target(refined_->signature)) {
    outcome.predicted_tool_error_m =
        calibrated_ && calibrated_->deflections
            ? predicted_where_measured(*tool)
            : uncertainty::predicted_rms(*refined_, nominal_.limits, *tool);
  }
  const auto scratch = std::make_unique<refinement::Refined>();
  if (calibrated_) {
    for (const std::size_t t : calibrated_->alone) {
      outcome.undetermined.push_back(
          fmt::format("target {}: a single row sees it, and nothing checks that row",
                      refined_->signature.targets[t].number));
    }
    outcome.noise = calibrated_->noise;
    outcome.left_out = calibrated_->left_out;
    outcome.deflections = calibrated_->deflections;
    if (calibrated_->deflections) {
      outcome.geometry_left_out_mean_m = calibrated_->geometry->mean_m;
    }
    if (const auto& score = calibrated_->left_out) {
      outcome.cross_validation =
          refinement::CrossValidation{score->rows, score->mean_m, score->rms_m, score->largest_m};
    }
  } else if (const auto crossed = refinement::cross_validate(refined_->signature, rows, config_,
                                                             verdicts_, *scratch)) {
    outcome.cross_validation = *crossed;
  }
  const bool crossed = outcome.cross_validation.has_value();
  if (crossed && config_.request.readings.empty() && !further.choose_readings &&
      rows.size() <= kMostRowsToOffer) {
    refinement::CrossValidation best;
    const auto chosen = refinement::choose_reading_terms(refined_->signature, rows, config_,
                                                         verdicts_, *scratch, best);
    // Against the model that was found, which may hold more than geometry.
    const bool better = best.mean_m < kWorthOffering * outcome.cross_validation->mean_m;
    if (chosen && any(*chosen) && better)
      outcome.offered = OfferedCorrections{*chosen, best.mean_m};
  }
  outcome.refined = std::move(refined_);
  return outcome;
}

}  // namespace

Read<RefinementOutcome> run_refinement(const Arm& nominal, const std::optional<Signature>& start,
                                       MeasurementLog& log,
                                       const std::optional<SensorDescription>& sensor,
                                       const FurtherUnknowns& further, const std::string& file) {
  return Run(nominal, log, sensor, file)(start, further);
}

}  // namespace armsig::tool
