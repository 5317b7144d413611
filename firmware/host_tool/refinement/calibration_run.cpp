// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/calibration_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/calibration/signature_of_model.hpp"
#include "core/refinement/determination.hpp"
#include "core/refinement/zero_offsets.hpp"
#include "firmware/host_tool/refinement/fitting.hpp"

namespace armsig::tool {
namespace {

using calibration::Engine;

// Rows that may be rejected before the fit itself is in doubt.
constexpr double kMostRejected = 0.4;
// Drawings further off than this, base and targets fitted, have other zeros than the encoders.
constexpr double kZerosInDoubt_m = 0.02;
// A stated variance beyond what the residuals show by so many of their own sigma is not believed,
// and one below it leaves something unexplained.
constexpr double kChance = 3;
// No sensor of a file without sigmas is taken to be without noise.
constexpr double kSmallShare = 1e-3;

// A richer model must earn its keep by this much on poses that it has not seen.
constexpr double kWorthDeflections = 0.98;
// Corrections that nobody asked for are tried on logs up to this long: a second or two.
constexpr std::size_t kMostRowsToOffer = 1000;
constexpr double kWorthCorrections = 0.95;
// A scale known no better than this (1.7 K of air temperature) counts as unknown.
constexpr double kLeastScaleSigma = 1e-3;
constexpr calibration::ModelParts kGeometry{.gravity = false, .maps = false};

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

// A model fitted to everything, and scored on poses left out.
struct Candidate {
  std::unique_ptr<refinement::Refined> refined = std::make_unique<refinement::Refined>();
  std::shared_ptr<calibration::ArmModel> model;
  calibration::FitSummary summary;
  std::optional<calibration::HeldOutScore> left_out;
  std::vector<refinement::RowOutcome> verdicts;
  std::vector<std::size_t> alone;
  double variance = 0;
};

class CalibrationFit {
 public:
  CalibrationFit(const CalibrationLog& log, std::span<refinement::RowOutcome> verdicts)
      : log_(log), verdicts_(verdicts), fitting_(log) {}

  std::expected<Calibrated, Refusal> operator()() {
    const auto drawn = refinement::fit_base_and_tool(log_.nominal, log_.positions, log_.targets);
    if (!drawn && !log_.start) return std::unexpected(drawn.error());
    if (drawn) found_.drawing_rms_m = drawn->rms_m;
    if (drawn && drawn->rms_m <= limits_.drawn_rms_m &&
        attempt(start_from_drawing(log_, log_.nominal, *drawn), true)) {
      return std::move(found_);
    }
    if (drawn && drawn->rms_m > kZerosInDoubt_m) {
      const auto zeroed = refinement::fit_zeros(log_.nominal, log_.positions, log_.targets);
      if (zeroed && zeroed->fitted.rms_m <= limits_.drawn_rms_m &&
          attempt(start_from_drawing(log_, zeroed->arm, zeroed->fitted), true)) {
        found_.zero_shifts = zeroed->shifts;
        return std::move(found_);
      }
    }
    if (log_.start && attempt(start_from_signature(log_), false)) return std::move(found_);
    return std::unexpected(refused_.value_or(
        Refusal{Error::kNotConverged, found_.drawing_rms_m, limits_.drawn_rms_m}));
  }

 private:
  // What a fit may be left with: an arm's, or a coarse sensor's.
  [[nodiscard]] double most_m() const {
    return std::max(limits_.rms_m, kCoarse * std::sqrt(fitting_.stated_variance()));
  }

  // True, and everything found, where the fit from there is to be believed. `upright`: the start
  // has the drawing's base.
  bool attempt(const FitStart& from, bool upright) {
    auto geometry = fitted(from, kGeometry, log_.request);
    if (!geometry) return note(geometry.error());
    if (const auto good = believable(from, *geometry); !good) return note(good.error());
    geometry->left_out = fitting_.score(from, kGeometry);
    FitStart chosen = from;
    found_.request = log_.request;
    std::optional<Corrected> corrected;
    if (log_.choose_readings || may_offer()) corrected = best_correction(from, *geometry);
    if (log_.choose_readings && corrected) {
      geometry = std::move(corrected->candidate);
      chosen = std::move(corrected->start);
      found_.request = corrected->request;
    }
    found_.geometry = geometry->left_out;
    std::optional<Candidate> whole;
    if (upright) whole = with_deflections(chosen, *geometry);
    if (const auto done = adopt(whole ? std::move(*whole) : std::move(*geometry)); !done) {
      return note(done.error());
    }
    if (corrected && !log_.choose_readings) offer(*corrected);
    return true;
  }

  // A geometry with corrections of the readings.
  struct Corrected {
    FitStart start;
    refinement::ParameterRequest request;
    refinement::ReadingTerms terms;
    Candidate candidate;
  };

  [[nodiscard]] bool may_offer() const {
    return log_.request.readings.empty() && log_.rows.size() <= kMostRowsToOffer;
  }

  // Those corrections that predict poses left out better by kWorthCorrections than fewer of them,
  // if any do.
  std::optional<Corrected> best_correction(const FitStart& from, const Candidate& plain) {
    std::optional<Corrected> best;
    if (!plain.left_out) return best;
    calibration::HeldOutScore to_beat = *plain.left_out;
    constexpr std::array<refinement::ReadingTerms, 4> kRicher{
        {{false, true, false}, {false, false, true}, {true, true, false}, {true, true, true}}};
    for (const refinement::ReadingTerms& terms : kRicher) {
      Corrected trial{from, log_.request, terms, {}};
      trial.request.readings.resize(log_.nominal.joints.size(), terms);
      calibration::ask_for(trial.request, trial.start.model);
      if (!fits_the_engine(trial.start)) continue;
      auto candidate = fitted(trial.start, kGeometry, trial.request);
      // A model too rich for the rows is no error, only no choice.
      if (!candidate || !believable(trial.start, *candidate)) continue;
      candidate->left_out = fitting_.score(trial.start, kGeometry);
      if (!better(candidate->left_out, to_beat, kWorthCorrections)) continue;
      to_beat = *candidate->left_out;
      trial.candidate = std::move(*candidate);
      best = std::move(trial);
    }
    return best;
  }

  // Against the model that was found, which may hold more than geometry.
  void offer(const Corrected& corrected) {
    if (!found_.left_out ||
        !better(corrected.candidate.left_out, *found_.left_out, kWorthCorrections)) {
      return;
    }
    found_.offered = OfferedCorrections{corrected.terms, corrected.candidate.left_out->mean_m};
  }

  static bool better(const std::optional<calibration::HeldOutScore>& score,
                     const calibration::HeldOutScore& than, double share) {
    return score && score->mean_kept_m <= share * than.mean_kept_m && score->mean_m <= than.mean_m;
  }

  static bool fits_the_engine(const FitStart& start) {
    return Engine::columns(start.model, start.targets.size()) <= calibration::kMaxGeometry;
  }

  // The first reason counts: it is about the drawing as it is.
  bool note(const Refusal& refusal) {
    if (!refused_) refused_ = refusal;
    return false;
  }

  std::expected<Candidate, Refusal> fitted(const FitStart& from,
                                           const calibration::ModelParts& parts,
                                           const refinement::ParameterRequest& request) {
    FitStart start = from;
    const auto summary = fitting_.run(start, parts);
    if (!summary) return std::unexpected(Refusal{summary.error(), 0, 0});
    Candidate found;
    found.summary = *summary;
    found.variance = fitting_.engine().scales().sigma_squared;
    found.model = std::make_shared<calibration::ArmModel>(start.model);
    refinement::Refined& refined = *found.refined;
    refined.signature = from.signature;
    refined.signature.s_model.clear();
    refined.signature.pseudo_dh.clear();
    refined.readings.couplings = log_.nominal.couplings;
    if (!request.readings.empty()) {
      for (const calibration::JointModel& joint : start.model.joints) {
        refined.readings.corrections.push_back(joint.correction);
      }
    }
    refined.receiver_offsets_m = start.model.sensor.offset_m;
    refined.scale = start.model.sensor.scale;
    found.verdicts.resize(verdicts_.size());
    fitting_.report(found.verdicts, refined.quality);
    refined.quality.iterations = summary->rounds;
    refined.quality.noise_freedom =
        static_cast<double>(refined.quality.scalars) - summary->degrees_of_model;
    std::vector<double> scratch(refinement::kMaxParameters * refinement::kMaxParameters);
    const auto done = calibration::geometry_to_signature(
        start.model, start.targets, fitting_.engine(), refined, request, scratch);
    if (!done) return std::unexpected(done.error());
    for (std::size_t t = 0; t < start.targets.size(); ++t) {
      if (start.targets[t].rows == 1) found.alone.push_back(t);
    }
    return found;
  }

  std::expected<void, Refusal> believable(const FitStart& from, const Candidate& found) const {
    const auto refuse = [](Error error, double value, double allowed) {
      return std::unexpected(Refusal{error, value, allowed});
    };
    const double allowed = kMostRejected * static_cast<double>(found.summary.rows);
    if (static_cast<double>(found.summary.rejected) > allowed) {
      return refuse(Error::kTooManyOutliers, static_cast<double>(found.summary.rejected), allowed);
    }
    if (const double rms_m = found.refined->quality.rms_m; !(rms_m <= most_m())) {
      return refuse(Error::kNotConverged, rms_m, most_m());
    }
    if (log_.start) return {};
    return refinement::like_its_drawing(from.signature, found.refined->signature, limits_);
  }

  // Gravity and maps too, where they predict poses left out better by kWorthDeflections.
  std::optional<Candidate> with_deflections(const FitStart& from, const Candidate& geometry) {
    if (!geometry.left_out) return std::nullopt;
    FitStart bent = from;
    calibration::choose_gravity_terms(log_.nominal, bent.model);
    if (!fits_the_engine(bent)) return std::nullopt;
    auto whole = fitted(bent, {}, found_.request);
    if (!whole || !believable(from, *whole)) return std::nullopt;
    fitting_.note_covered(*whole->model);
    whole->left_out = fitting_.score(bent, {});
    const auto& score = whole->left_out;
    if (!better(score, *geometry.left_out, kWorthDeflections)) return std::nullopt;
    const double k = score->factor;
    for (calibration::JointModel& joint : whole->model->joints) {
      joint.deviation.fill(0);
      for (float& variance : joint.map_variance) variance *= static_cast<float>(k * k);
    }
    whole->refined->readings.deflections = whole->model.get();
    found_.deflections = whole->model;
    return std::move(*whole);
  }

  std::expected<void, Refusal> adopt(Candidate chosen) {
    std::ranges::copy(chosen.verdicts, verdicts_.begin());
    found_.refined = std::move(chosen.refined);
    found_.summary = chosen.summary;
    found_.left_out = chosen.left_out;
    found_.alone = chosen.alone;
    if (const auto named = name_undetermined(); !named) return named;
    state(chosen.variance);
    return {};
  }

  // By the rows alone, without the priors of the engine. Refuses a scale that nothing tells.
  std::expected<void, Refusal> name_undetermined() {
    refinement::Refined& refined = *found_.refined;
    const refinement::SquareRootFactor information = refined.information;
    refinement::RefinementConfig config;
    config.readings = refined.readings;
    config.receivers = log_.receivers;
    config.compress_sweeps = false;
    std::vector<refinement::RowOutcome> outcomes(verdicts_.begin(), verdicts_.end());
    const Signature start = refined.signature;
    refinement::Problem problem(start, log_.rows, config, outcomes, refined);
    problem.evaluate();
    problem.linearise(problem.noise());
    static_cast<void>(refinement::find_undetermined(problem, config.prior, refined));
    if (found_.request.scale) {
      const double sigma = refinement::parameter_sigma(refined.information, refined.layout.scale);
      if (sigma > kLeastScaleSigma) {
        return std::unexpected(Refusal{Error::kScaleUndetermined, sigma, kLeastScaleSigma});
      }
    }
    refined.information = information;
    return {};
  }

  void state(double variance) {
    refinement::Refined& refined = *found_.refined;
    refinement::FitQuality& quality = refined.quality;
    const double k = found_.left_out ? found_.left_out->factor : 1;
    const double shown = k * k * variance;
    const double stated = fitting_.stated_variance();
    found_.noise = noise_of(shown, quality.noise_freedom, stated);
    const NoiseStatement& noise = found_.noise;
    refined.information.scale(1 / k);
    for (Target& target : refined.signature.targets) target.covariance_m2 *= k * k;
    quality.sigma_is_estimated = noise.stated_m == 0 || noise.contradicted;
    quality.sigma_m = quality.sigma_is_estimated ? kSmallShare * noise.total_m : noise.stated_m;
    quality.unexplained_m = noise.unexplained_m;
    quality.noise_factor = noise.stated_m > 0 ? noise.total_m / noise.stated_m : 1;
    quality.covariance_enlarged =
        stated > 0 && shown > stated * (1 + chance(quality.noise_freedom));
  }

  // Residual lengths of three coordinates are 1.7 sigma; so many are more than outliers let
  // through.
  static constexpr double kCoarse = 4;

  const CalibrationLog& log_;
  std::span<refinement::RowOutcome> verdicts_;
  Fitting fitting_;
  Calibrated found_;
  std::optional<Refusal> refused_;
  // An arm of several metres, or one driven by cables, may be left with more than a table-top one.
  refinement::StartLimits limits_{.rms_m = 10e-3};
};

}  // namespace

std::expected<Calibrated, Refusal> run_calibration(const CalibrationLog& log,
                                                   std::span<refinement::RowOutcome> verdicts) {
  return CalibrationFit(log, verdicts)();
}

}  // namespace armsig::tool
