// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/calibration_run.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/analysis/starts/determination.hpp"
#include "firmware/analysis/starts/zero_offsets.hpp"
#include "firmware/host_tool/refinement/candidates.hpp"
#include "firmware/host_tool/refinement/coupled_joints.hpp"

namespace armsig::tool {
namespace {

// Drawings further off than this, base and targets fitted, have other zeros than the encoders.
constexpr double kZerosInDoubt_m = 0.02;
// A stated variance beyond what the residuals show by so many of their own sigma is not believed,
// and one below it leaves something unexplained.
constexpr double kChance = 3;
// No sensor of a file without sigmas is taken to be without noise.
constexpr double kSmallShare = 1e-3;

// Corrections that nobody asked for are tried on logs up to this long: a second or two.
constexpr std::size_t kMostRowsToOffer = 1000;
// Where they are needed, they are found unasked: they predict so much better, or explain some of
// the rows that are blunders without them.
constexpr double kNeedsCorrections = 0.8;
// A scale known no better than this (1.7 K of air temperature) counts as unknown.
constexpr double kLeastScaleSigma = 1e-3;
// Play is looked for where a score test says so much of it (a logarithm of likelihoods): beside the
// geometry alone, whose gravity and maps look like it, and beside the model that was chosen.
constexpr double kClearPlay = 40;
constexpr double kWorthPlay = 12;

// Of a variance found with so many degrees of freedom: what chance may add to it, as a share.
double chance(double freedom) { return kChance * std::sqrt(2 / std::max(freedom, 1.0)); }

// Noise and model error apart: the sensor's own noise is what is stated, as far as the residuals
// leave room for it. What they show beyond it is the arm's, whether or not it could be chance: the
// best estimate, floored at zero.
NoiseStatement noise_of(double variance, double freedom, double stated_variance) {
  NoiseStatement noise;
  noise.total_m = std::sqrt(variance);
  noise.stated_m = std::sqrt(stated_variance);
  noise.contradicted = variance * (1 + chance(freedom)) < stated_variance;
  const double sensor = noise.contradicted ? 0 : stated_variance;
  noise.unexplained_m = std::sqrt(std::max(0.0, variance - sensor));
  return noise;
}

// Poses of the nominal model are kept between the passes over up to so many rows: 20 MB.
constexpr std::size_t kMostPosesKept = 200'000;

class CalibrationFit {
 public:
  CalibrationFit(const CalibrationLog& log, std::span<calibration::RowOutcome> verdicts)
      : log_(log), verdicts_(verdicts), candidates_(log) {}

  std::expected<Calibrated, Refusal> operator()() {
    const double most_m = candidates_.limits().drawn_rms_m;
    const auto drawn = fit_drawn();
    if (!drawn && !log_.start) return std::unexpected(drawn.error());
    if (drawn) found_.nominal_rms_m = drawn->rms_m;
    if (drawn) found_.drawn = *drawn;
    if (drawn && drawn->rms_m <= most_m &&
        attempt(start_from_drawing(log_, log_.nominal, *drawn), true)) {
      return std::move(found_);
    }
    if (drawn && drawn->rms_m > kZerosInDoubt_m) {
      const auto zeroed = calibration::fit_zeros(log_.nominal, log_.positions, log_.targets);
      if (zeroed && zeroed->fitted.rms_m <= most_m &&
          attempt(start_from_drawing(log_, zeroed->arm, zeroed->fitted), true)) {
        found_.zero_shifts = zeroed->shifts;
        return std::move(found_);
      }
    }
    if (log_.start && attempt(start_from_signature(log_), false)) return std::move(found_);
    return std::unexpected(
        refused_.value_or(Refusal{Error::kNotConverged, found_.nominal_rms_m, most_m}));
  }

 private:
  [[nodiscard]] Judged<calibration::BaseAndTool> fit_drawn() const {
    const std::size_t rows = log_.positions.size();
    std::vector<Pose> poses(rows <= kMostPosesKept ? rows : 0);
    return calibration::fit_base_and_tool(log_.nominal, log_.positions, log_.targets, poses);
  }

  // A geometry, and the same with gravity and maps where they help.
  struct Choice {
    Candidate geometry;
    std::optional<Candidate> whole;

    [[nodiscard]] Candidate& best() { return whole ? *whole : geometry; }
  };

  // True, and everything found, where the fit from there is to be believed. `upright`: the start
  // has the drawing's base.
  bool attempt(const FitStart& from, bool upright) {
    candidates_.gather(from);
    auto geometry = candidates_.geometry(from);
    if (!geometry) return note(geometry.error());
    auto played = candidates_.played(*geometry, kClearPlay);
    std::optional<Choice> chosen;
    if (played) chosen = corrected(std::move(*played), upright);
    if (!chosen || !has_certain_play(chosen->best())) {
      candidates_.find_play(false);
      chosen = corrected(std::move(*geometry), upright);
      played = candidates_.played(chosen->best(), kWorthPlay);
      if (played) chosen->best() = std::move(*played);
    }
    found_.coupling = find_coupling(log_, candidates_, chosen->best());
    if (const auto done = adopt(std::move(*chosen)); !done) return note(done.error());
    return true;
  }

  // With corrections of the readings where they are asked for or needed.
  Choice corrected(Candidate geometry, bool upright) {
    const bool unasked = may_correct(geometry);
    std::optional<Candidate> corrected;
    if (log_.choose_readings || unasked) corrected = candidates_.corrected(geometry);
    if (corrected && log_.choose_readings) {
      geometry = std::move(*corrected);
      corrected.reset();
    }
    found_.offered.reset();
    Choice chosen = choose(std::move(geometry), upright);
    if (corrected && predicts_better(*corrected, chosen.best(), kWorthCorrections)) {
      if (predicts_better(*corrected, chosen.best(), kNeedsCorrections) ||
          taken_back(*corrected, chosen.best()) >= kFewestTakenBack) {
        chosen = choose(std::move(*corrected), upright);
      } else {
        found_.offered =
            OfferedCorrections{corrected->request.readings[0], corrected->left_out->score.mean_m};
      }
    }
    if (unasked && chosen.whole) {
      auto geared = candidates_.geared(chosen.geometry, *chosen.whole);
      if (geared) chosen = choose(std::move(*geared), upright);
    }
    return chosen;
  }

  Choice choose(Candidate geometry, bool upright) {
    Choice choice{std::move(geometry), std::nullopt};
    if (upright) choice.whole = candidates_.deflected(choice.geometry);
    return choice;
  }

  // Of long logs, only where rows are rejected that they may explain.
  [[nodiscard]] bool may_correct(const Candidate& geometry) {
    if (log_.as_read || !log_.request.readings.empty() || !geometry.left_out) return false;
    return log_.rows.size() <= kMostRowsToOffer || candidates_.corrections_take_back(geometry);
  }

  // The first reason counts: it is about the drawing as it is.
  bool note(const Refusal& refusal) {
    if (!refused_) refused_ = refusal;
    return false;
  }

  std::expected<void, Refusal> adopt(Choice choice) {
    Candidate& best = choice.best();
    std::ranges::copy(best.verdicts, verdicts_.begin());
    found_.request = best.request;
    found_.refined = std::move(best.refined);
    found_.summary = best.summary;
    if (best.left_out) found_.left_out = best.left_out->score;
    if (best.left_out) found_.left_out_m = std::move(best.left_out->length_m);
    found_.tried = candidates_.tried();
    if (best.left_out) found_.tried[best.tried].written = true;
    if (choice.geometry.left_out) found_.geometry = choice.geometry.left_out->score;
    if (best.deflected) found_.deflections = best.model;
    found_.alone = best.alone;
    found_.merged_rows = candidates_.merged_rows();
    found_.half_plays = best.half_plays;
    found_.moved_by_play = std::move(best.moved_by_play);
    if (const auto named = name_undetermined(best.variance); !named) return named;
    state(best.variance);
    return {};
  }

  // Refuses a scale that the rows alone do not tell.
  std::expected<void, Refusal> name_undetermined(double variance) {
    calibration::Refined& refined = *found_.refined;
    const auto alone = std::make_unique<calibration::RowsAlone>();
    calibration::gather_rows(log_.rows, verdicts_, log_.receivers, std::sqrt(variance), refined,
                             *alone);
    calibration::name_undetermined(*alone, refined);
    if (!found_.request.scale) return {};
    const double sigma = calibration::parameter_sigma(alone->information, refined.layout.scale);
    if (sigma <= kLeastScaleSigma) return {};
    return std::unexpected(Refusal{Error::kScaleUndetermined, sigma, kLeastScaleSigma});
  }

  void state(double variance) {
    calibration::Refined& refined = *found_.refined;
    calibration::FitQuality& quality = refined.quality;
    const double k = found_.left_out ? found_.left_out->factor : 1;
    const double shown = k * k * variance;
    const double stated = candidates_.stated_variance();
    found_.noise = noise_of(shown, quality.noise_freedom, stated);
    NoiseStatement& noise = found_.noise;
    noise.unexplained_m = std::hypot(noise.unexplained_m, play_m());
    refined.information.scale(1 / k);
    for (Target& target : refined.signature.targets) target.covariance_m2 *= k * k;
    quality.sigma_is_estimated = noise.stated_m == 0 || noise.contradicted;
    quality.sigma_m = quality.sigma_is_estimated ? kSmallShare * noise.total_m : noise.stated_m;
    quality.unexplained_m = noise.unexplained_m;
    quality.noise_factor = noise.stated_m > 0 ? noise.total_m / noise.stated_m : 1;
    quality.covariance_enlarged =
        stated > 0 && shown > stated * (1 + chance(quality.noise_freedom));
  }

  // Play moves the target of a row by, per axis; nobody knows from which side a pose will be
  // reached that is asked for later.
  [[nodiscard]] double play_m() const {
    if (found_.half_plays.empty()) return 0;
    double squares = 0;
    for (const Vector3& moved : found_.moved_by_play) squares += moved.squaredNorm();
    return std::sqrt(squares / (3 * static_cast<double>(found_.moved_by_play.size())));
  }

  const CalibrationLog& log_;
  std::span<calibration::RowOutcome> verdicts_;
  Candidates candidates_;
  Calibrated found_;
  std::optional<Refusal> refused_;
};

}  // namespace

std::expected<Calibrated, Refusal> run_calibration(const CalibrationLog& log,
                                                   std::span<calibration::RowOutcome> verdicts) {
  return CalibrationFit(log, verdicts)();
}

}  // namespace armsig::tool
