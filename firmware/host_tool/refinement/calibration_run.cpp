// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/calibration_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/calibration/signature_of_model.hpp"
#include "core/refinement/determination.hpp"
#include "core/refinement/zero_offsets.hpp"

namespace armsig::tool {
namespace {

using calibration::ArmModel;
using calibration::Engine;
using calibration::FitRow;
using calibration::ModelTarget;

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
constexpr calibration::ModelParts kGeometry{.gravity = false, .maps = false};

// Where a fit starts: a chain, and the targets in its links.
struct Start {
  ArmModel model;
  std::vector<ModelTarget> targets;
  Signature signature;  // whose frames the result is put into
  double rms_m = 0;
};

Start start_from_drawing(const CalibrationLog& log, const Arm& arm,
                         const refinement::BaseAndTool& fitted) {
  Start start{
      calibration::model_of(arm, fitted.X_SB),
      {},
      log.start ? *log.start : refinement::drawn_signature(arm, fitted, log.rows, log.targets),
      fitted.rms_m};
  for (std::size_t t = 0; t < log.targets.size(); ++t) {
    start.targets.push_back({.link = log.targets[t].link, .p_L = fitted.p_LT[t]});
  }
  return start;
}

// The signature that the features gave, as a chain: for drawings that lead nowhere.
Start start_from_signature(const CalibrationLog& log) {
  const Signature& signature = *log.start;
  Start start{{}, {}, signature, 0};
  start.model.couplings = log.nominal.couplings;
  start.model.X_SB = signature.X_SL[0];
  for (std::size_t i = 0; i < signature.joint_count(); ++i) {
    calibration::JointModel joint;
    joint.type = signature.types[i];
    joint.offset = -signature.configuration[i];
    joint.after = signature.X_SL[i].inverse() * signature.X_SL[i + 1];
    joint.domain = calibration::map_domain(joint.type, log.nominal.limits[i]);
    start.model.joints.push_back(joint);
  }
  for (const Target& target : signature.targets) {
    start.targets.push_back(
        {.link = target.link, .p_L = signature.X_SL[target.link].inverse() * target.p_S});
  }
  return start;
}

// The rows as the engine wants them, and its memory.
class Fitting {
 public:
  explicit Fitting(const CalibrationLog& log) : log_(log), rows_(log.rows.size()) {
    double stated = 0;
    std::size_t count = 0;
    for (const refinement::Observation& row : log.rows) {
      if (!(row.sigma_m > 0)) continue;
      stated += row.sigma_m * row.sigma_m;
      ++count;
    }
    if (count > 0) stated_variance_ = stated / static_cast<double>(count);
    std::vector<JointType> types;
    for (const DhJoint& joint : log.nominal.joints) types.push_back(joint.type);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const refinement::Observation& from = log.rows[k];
      FitRow& row = rows_[k];
      row.readings = from.readings;
      row.p_S = from.p_S;
      row.target = static_cast<std::uint8_t>(from.target);
      row.sweep = static_cast<std::uint8_t>(from.sweep);
      row.index = static_cast<std::uint32_t>(k);
      if (!(from.sigma_m > 0)) continue;
      const auto relative = static_cast<float>(from.sigma_m * from.sigma_m / stated_variance_);
      // Rounding must not make rows of one sigma differ.
      if (std::abs(relative - 1.0F) > 1e-5F) row.relative = {relative, 0, 0, relative, 0, relative};
    }
    calibration::group_poses(rows_, types);
    poses_ = calibration::deal_folds(rows_);
    cache_.resize(rows_.size());
  }

  // Fits from `start`, which becomes the result.
  Result<calibration::FitSummary> run(Start& start, const calibration::ModelParts& parts) {
    matrix_.resize(calibration::matrix_size(Engine::columns(start.model, start.targets.size())));
    engine_ = std::make_unique<Engine>(start.model, start.targets, rows_, cache_, matrix_, *work_);
    engine_->set_stated_variance(stated_variance_);
    return engine_->run(parts);
  }

  // Of the model found by run(), from its start; destroys what the engine knows.
  std::optional<calibration::HeldOutScore> score(Start start,
                                                 const calibration::ModelParts& parts) {
    if (poses_ < calibration::kFolds) return std::nullopt;
    const auto rejected = std::make_unique<bool[]>(rows_.size());
    for (std::size_t k = 0; k < rows_.size(); ++k) rejected[k] = rows_[k].weight == 0;
    std::vector<calibration::RowScore> scores(rows_.size());
    std::vector<float> order(rows_.size());
    const calibration::Scales scales = engine_->scales();
    const auto left_out = calibration::score_held_out(
        {start.model, start.targets, rows_, cache_, matrix_, *work_, stated_variance_}, parts,
        scales, {rejected.get(), rows_.size()}, scores, order);
    if (!left_out || left_out->rows == left_out->rejected) return std::nullopt;
    return *left_out;
  }

  [[nodiscard]] Engine& engine() { return *engine_; }
  [[nodiscard]] double stated_variance() const { return stated_variance_; }
  [[nodiscard]] const std::vector<FitRow>& rows() const { return rows_; }

  // Between which readings the rows are that were not rejected.
  void note_covered(ArmModel& model) const {
    for (std::size_t i = 0; i < model.joint_count(); ++i) {
      JointLimits& covered = model.joints[i].covered;
      covered = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
      for (const FitRow& row : rows_) {
        if (row.weight == 0) continue;
        covered.lower = std::min(covered.lower, row.readings[i]);
        covered.upper = std::max(covered.upper, row.readings[i]);
      }
    }
  }

  void report(std::span<refinement::RowOutcome> verdicts, refinement::FitQuality& quality) const {
    double squares = 0;
    for (const FitRow& row : rows_) {
      verdicts[row.index] = {row.residual.norm(), row.weight, row.weight == 0};
      if (row.weight == 0) {
        ++quality.rows_rejected;
        continue;
      }
      ++quality.rows_used;
      squares += row.residual.squaredNorm();
    }
    quality.scalars = 3 * quality.rows_used;
    quality.rms_m = std::sqrt(squares / static_cast<double>(quality.rows_used));
  }

 private:
  const CalibrationLog& log_;
  std::vector<FitRow> rows_;
  std::vector<calibration::ChainFrames> cache_;
  std::vector<double> matrix_;
  std::unique_ptr<calibration::Workspace> work_ = std::make_unique<calibration::Workspace>();
  std::unique_ptr<Engine> engine_;
  double stated_variance_ = 0;
  std::size_t poses_ = 0;
};

// Noise and model error apart: the sensor's own noise is what is stated, as far as the residuals
// leave room for it.
NoiseStatement noise_of(double variance, double freedom, double stated_variance) {
  NoiseStatement noise;
  noise.total_m = std::sqrt(variance);
  noise.stated_m = std::sqrt(stated_variance);
  const double chance = kChance * std::sqrt(2 / std::max(freedom, 1.0));
  noise.contradicted = variance * (1 + chance) < stated_variance;
  if (stated_variance == 0 || noise.contradicted) {
    noise.unexplained_m = noise.total_m;
  } else if (variance > stated_variance * (1 + chance)) {
    noise.unexplained_m = std::sqrt(variance - stated_variance);
  }
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
    const auto drawn = refinement::fit_base_and_tool(log_.nominal, log_.rows, log_.targets);
    if (!drawn && !log_.start) return std::unexpected(drawn.error());
    if (drawn) found_.drawing_rms_m = drawn->rms_m;
    if (drawn && drawn->rms_m <= limits_.drawn_rms_m &&
        attempt(start_from_drawing(log_, log_.nominal, *drawn), true)) {
      return std::move(found_);
    }
    if (drawn && drawn->rms_m > kZerosInDoubt_m) {
      const auto zeroed = refinement::fit_zeros(log_.nominal, log_.rows, log_.targets);
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
  // True, and everything found, where the fit from there is to be believed. `upright`: the start
  // has the drawing's base.
  bool attempt(const Start& from, bool upright) {
    auto geometry = fitted(from, kGeometry);
    if (!geometry) return note(geometry.error());
    if (const auto good = believable(from, *geometry); !good) return note(good.error());
    geometry->left_out = fitting_.score(from, kGeometry);
    found_.geometry = geometry->left_out;
    std::optional<Candidate> whole;
    if (upright) whole = with_deflections(from, *geometry);
    adopt(whole ? std::move(*whole) : std::move(*geometry));
    return true;
  }

  // The first reason counts: it is about the drawing as it is.
  bool note(const Refusal& refusal) {
    if (!refused_) refused_ = refusal;
    return false;
  }

  std::expected<Candidate, Refusal> fitted(const Start& from,
                                           const calibration::ModelParts& parts) {
    Start start = from;
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
    found.verdicts.resize(verdicts_.size());
    fitting_.report(found.verdicts, refined.quality);
    refined.quality.iterations = summary->rounds;
    refined.quality.noise_freedom =
        3 * static_cast<double>(refined.quality.rows_used) - summary->degrees_of_model;
    std::vector<double> scratch(refinement::kMaxParameters * refinement::kMaxParameters);
    const auto done = calibration::geometry_to_signature(start.model, start.targets,
                                                         fitting_.engine(), refined, scratch);
    if (!done) return std::unexpected(done.error());
    for (std::size_t t = 0; t < start.targets.size(); ++t) {
      if (start.targets[t].rows == 1) found.alone.push_back(t);
    }
    return found;
  }

  std::expected<void, Refusal> believable(const Start& from, const Candidate& found) const {
    const auto refuse = [](Error error, double value, double allowed) {
      return std::unexpected(Refusal{error, value, allowed});
    };
    const double allowed = kMostRejected * static_cast<double>(found.summary.rows);
    if (static_cast<double>(found.summary.rejected) > allowed) {
      return refuse(Error::kTooManyOutliers, static_cast<double>(found.summary.rejected), allowed);
    }
    const double most = std::max(limits_.rms_m, kCoarse * std::sqrt(fitting_.stated_variance()));
    if (const double rms_m = found.refined->quality.rms_m; !(rms_m <= most)) {
      return refuse(Error::kNotConverged, rms_m, most);
    }
    if (log_.start) return {};
    return refinement::like_its_drawing(from.signature, found.refined->signature, limits_);
  }

  // Gravity and maps too, where they predict poses left out better by kWorthDeflections.
  std::optional<Candidate> with_deflections(const Start& from, const Candidate& geometry) {
    if (!geometry.left_out) return std::nullopt;
    Start bent = from;
    calibration::choose_gravity_terms(log_.nominal, bent.model);
    if (Engine::columns(bent.model, bent.targets.size()) > calibration::kMaxGeometry) {
      return std::nullopt;
    }
    auto whole = fitted(bent, {});
    if (!whole || !believable(from, *whole)) return std::nullopt;
    fitting_.note_covered(*whole->model);
    whole->left_out = fitting_.score(bent, {});
    const auto& score = whole->left_out;
    if (!score || score->mean_kept_m > kWorthDeflections * geometry.left_out->mean_kept_m ||
        score->mean_m > geometry.left_out->mean_m) {
      return std::nullopt;
    }
    const double k = score->factor;
    for (calibration::JointModel& joint : whole->model->joints) {
      joint.deviation.fill(0);
      for (float& variance : joint.map_variance) variance *= static_cast<float>(k * k);
    }
    whole->refined->readings.deflections = whole->model.get();
    found_.deflections = whole->model;
    return std::move(*whole);
  }

  void adopt(Candidate chosen) {
    std::ranges::copy(chosen.verdicts, verdicts_.begin());
    found_.refined = std::move(chosen.refined);
    found_.summary = chosen.summary;
    found_.left_out = chosen.left_out;
    found_.alone = chosen.alone;
    name_undetermined();
    state(chosen.variance);
  }

  // By the rows alone, without the priors of the engine.
  void name_undetermined() {
    refinement::Refined& refined = *found_.refined;
    const refinement::SquareRootFactor information = refined.information;
    refinement::RefinementConfig config;
    config.readings = refined.readings;
    config.compress_sweeps = false;
    std::vector<refinement::RowOutcome> outcomes(verdicts_.begin(), verdicts_.end());
    const Signature start = refined.signature;
    refinement::Problem problem(start, log_.rows, config, outcomes, refined);
    problem.evaluate();
    problem.linearise(problem.noise());
    static_cast<void>(refinement::find_undetermined(problem, config.prior, refined));
    refined.information = information;
  }

  void state(double variance) {
    refinement::Refined& refined = *found_.refined;
    refinement::FitQuality& quality = refined.quality;
    const double k = found_.left_out ? found_.left_out->factor : 1;
    found_.noise = noise_of(k * k * variance, quality.noise_freedom, fitting_.stated_variance());
    const NoiseStatement& noise = found_.noise;
    refined.information.scale(1 / k);
    for (Target& target : refined.signature.targets) target.covariance_m2 *= k * k;
    quality.sigma_is_estimated = noise.stated_m == 0 || noise.contradicted;
    quality.sigma_m = quality.sigma_is_estimated ? kSmallShare * noise.total_m : noise.stated_m;
    quality.unexplained_m = noise.unexplained_m;
    quality.noise_factor = noise.stated_m > 0 ? noise.total_m / noise.stated_m : 1;
    quality.covariance_enlarged = noise.stated_m > 0 && noise.unexplained_m > 0;
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
