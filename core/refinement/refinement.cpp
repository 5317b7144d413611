// SPDX-License-Identifier: MIT
#include "core/refinement/refinement.hpp"

#include <algorithm>
#include <cmath>

#include "core/refinement/determination.hpp"
#include "core/refinement/problem.hpp"
#include "core/refinement/row.hpp"

namespace armsig::refinement {

namespace {

constexpr int kMaxIterations = 40;
constexpr int kMaxHalvings = 6;
// The last step, in sigma of the estimate: small enough to repeat the optimum to nanometres.
constexpr double kConvergedStep = 1e-6;
// A step that stays above kConvergedStep (rows at the gate going in and out) but no longer matters.
constexpr double kHarmlessStep = 0.05;
// A scale known no better than this (1.7 K of air temperature) counts as unknown.
constexpr double kLeastScaleSigma = 1e-3;
// Rows that may be rejected before the fit itself is in doubt.
constexpr double kRejectedShare = 0.4;
// Numbers beyond the unknowns from which a noise that nobody stated can be told at all.
constexpr std::size_t kToTellNoise = 3;

std::unexpected<Refusal> refuse(Error error, double found, double needed) {
  return std::unexpected(Refusal{error, found, needed});
}

// Which targets the log sees, how many numbers it holds; refuses what cannot be fitted at all.
struct Survey {
  std::array<bool, kMaxTargets> observed{};
  std::size_t rows = 0;
  std::size_t scalars = 0;
  bool noise_unknown = false;
};

std::expected<Survey, Refusal> survey(const Signature& start, std::span<const Observation> log) {
  Survey survey;
  bool moved = false;
  const Observation* first = nullptr;
  for (std::size_t k = 0; k < log.size(); ++k) {
    const Observation& row = log[k];
    ARMSIG_CHECK(row.target < start.targets.size() && row.sweep <= start.joint_count());
    if (!is_finite(row)) return refuse(Error::kNotFinite, static_cast<double>(k), 0);
    if (row.use != RowUse::kFit) continue;
    survey.observed[row.target] = true;
    survey.noise_unknown = survey.noise_unknown || !(row.sigma_m > 0);
    ++survey.rows;
    survey.scalars += row.kind == ObservationKind::kPosition ? 3 : 1;
    if (first == nullptr) first = &row;
    moved = moved || !std::equal(row.readings.begin(), row.readings.end(), first->readings.begin());
  }
  if (survey.rows > 1 && !moved) return refuse(Error::kJointDidNotMove, 0, 0);
  return survey;
}

void apply(const StateVector& x, double fraction, Refined& refined) {
  const Layout& layout = refined.layout;
  apply_corrections(layout, x, fraction, refined.signature, refined.readings);
  if (layout.scale != kNoColumn) refined.scale += fraction * x[layout.scale];
  if (layout.receiver_offsets == kNoColumn) return;
  for (std::size_t i = layout.receiver_offsets; i < layout.size(); ++i) {
    if (layout.parameters[i].kind != ParameterKind::kReceiverOffset) break;
    refined.receiver_offsets_m[layout.parameters[i].index] += fraction * x[i];
  }
}

// One damped Gauss-Newton step. Returns its length in sigma of the estimate.
Result<double> step(Problem& problem, const Noise& noise, Refined& refined) {
  const double before = problem.cost(noise);
  problem.linearise(noise);
  ARMSIG_TRY(x, refined.information.solve());
  const double length = std::sqrt(refined.information.solution_squares());
  double fraction = 1;
  apply(x, fraction, refined);
  problem.evaluate();
  for (int halving = 0; halving < kMaxHalvings; ++halving) {
    if (problem.cost(noise) <= before || length < kConvergedStep) break;
    fraction *= 0.5;
    apply(x, -fraction, refined);
    problem.evaluate();
  }
  return length;
}

// Steps until they no longer matter. Returns the length of the last one.
Judged<double> iterate(Problem& problem, Refined& refined, Noise& noise) {
  double length = 0;
  for (int i = 0; i < kMaxIterations; ++i) {
    noise = problem.noise();
    const Result<double> taken = step(problem, noise, refined);
    if (!taken) return refuse(taken.error(), 0, 0);
    ++refined.quality.iterations;
    // Steps shrink by about the same factor each time, so the next one is known beforehand.
    const double next = i == 0 ? *taken : *taken * std::min(1.0, *taken / length);
    length = *taken;
    if (next < kConvergedStep) break;
  }
  return length;
}

}  // namespace

std::expected<void, Refusal> refine(const Signature& start, std::span<const Observation> log,
                                    const RefinementConfig& config, std::span<RowOutcome> outcomes,
                                    Refined& refined) {
  ARMSIG_CHECK(outcomes.size() == log.size() && &start != &refined.signature);
  ARMSIG_TRY(surveyed, survey(start, log));
  ARMSIG_TRY(layout,
             make_layout(start, surveyed.observed, config.request, config.receivers.size()));
  const std::size_t needed = layout.size() + (surveyed.noise_unknown ? kToTellNoise : 0);
  if (surveyed.scalars < needed) {
    return refuse(Error::kTooFewPoints, static_cast<double>(surveyed.scalars),
                  static_cast<double>(needed));
  }
  refined.signature = start;
  refined.signature.s_model.clear();
  refined.signature.pseudo_dh.clear();
  refined.readings = config.readings;
  if (!config.request.readings.empty()) {
    refined.readings.corrections.resize(start.joint_count());
  }
  refined.receiver_offsets_m.fill(0);
  refined.scale = 0;
  refined.layout = layout;
  refined.quality = {};

  Problem problem(start, log, config, outcomes, refined);
  problem.evaluate();
  Noise noise;
  ARMSIG_TRY(length, iterate(problem, refined, noise));
  const std::array<bool, kMaxParameters> open = find_undetermined(problem, config.prior, refined);
  if (!refined.undetermined.empty()) {
    // Held for the estimate; for the covariance they are as open as the prior says.
    problem.hold(open);
    ARMSIG_TRY(held_length, iterate(problem, refined, noise));
    length = held_length;
    problem.release();
    problem.linearise(noise);
  }
  if (!(length < kHarmlessStep)) return refuse(Error::kNotConverged, length, kHarmlessStep);

  const double weighted_squares = problem.judge_rows(noise);
  const FitQuality& quality = refined.quality;
  const auto allowed = kRejectedShare * static_cast<double>(surveyed.rows);
  if (static_cast<double>(quality.rows_rejected) > allowed) {
    return refuse(Error::kTooManyOutliers, static_cast<double>(quality.rows_rejected), allowed);
  }
  if (layout.scale != kNoColumn && config.prior.scale == 0) {
    const double sigma = parameter_sigma(refined.information, layout.scale);
    if (sigma > kLeastScaleSigma) return refuse(Error::kScaleUndetermined, sigma, kLeastScaleSigma);
  }
  settle_covariance(weighted_squares, refined);
  return {};
}

}  // namespace armsig::refinement
