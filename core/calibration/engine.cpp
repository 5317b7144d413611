// SPDX-License-Identifier: MIT
#include "core/calibration/engine.hpp"

#include <algorithm>
#include <cmath>

#include "core/calibration/engine_detail.hpp"

namespace armsig::calibration {

namespace {

constexpr int kLeastRounds = 4;
constexpr int kMostRounds = 25;
constexpr int kSoftRounds = 2;
// Of the residuals' own scale: the coarse one has come down to it.
constexpr double kSettledScale = 2;
constexpr int kPasses = 2;
constexpr int kLastPasses = 8;
constexpr int kMostTries = 7;
// Of sigma: a step below it no longer matters. Of sigma^2, as a logarithm.
constexpr double kHarmlessStep = 0.03;
constexpr double kHarmlessChange = 0.01;
// Of what the linear model promised, kept.
constexpr double kGoodGain = 0.75;
constexpr double kPoorGain = 0.25;

}  // namespace

Engine::Engine(ArmModel& model, std::span<ModelTarget> targets, std::span<FitRow> rows,
               std::span<ChainFrames> cache, std::span<double> matrix, Workspace& work)
    : model_(model),
      targets_(targets),
      rows_(rows),
      cache_(cache),
      matrix_(matrix),
      work_(work),
      columns_(columns(model, targets.size())) {
  ARMSIG_CHECK(columns_ <= kMaxGeometry && matrix.size() >= matrix_size(columns_));
  ARMSIG_CHECK(cache.empty() || cache.size() == rows.size());
  constexpr std::array<float, 6> kUnit{1, 0, 0, 1, 0, 1};
  for (const FitRow& row : rows) {
    uniform_ = uniform_ && row.relative == kUnit && !row.is_range();
  }
}

const ChainFrames& Engine::frames_of(std::size_t row) {
  if (!cache_.empty()) return cache_[row];
  evaluate_chain(model_, rows_[row].readings, targets_[rows_[row].target].link, scratch_);
  return scratch_;
}

void Engine::evaluate() {
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    FitRow& row = rows_[k];
    const ModelTarget& target = targets_[row.target];
    ChainFrames& frames = cache_.empty() ? scratch_ : cache_[k];
    evaluate_chain(model_, row.readings, target.link, frames);
    evaluate(row, frames);
  }
}

void Engine::evaluate(FitRow& row, const ChainFrames& frames) const {
  const Vector3 p_S = frames.X_SL * targets_[row.target].p_L;
  const SensorModel& sensor = model_.sensor;
  if (!row.is_range()) {
    row.residual = row.p_S - (1 + sensor.scale) * p_S;
    return;
  }
  const Vector3 way = p_S - sensor.receivers[row.receiver];
  const double length = way.norm();
  // A target on the receiver itself has no direction; its row then says nothing about the target.
  row.p_S = length > 0 ? Vector3(way / length) : Vector3::Zero();
  const double predicted = (1 + sensor.scale) * length + sensor.offset_m[row.receiver];
  row.residual = (row.range_m - predicted) * row.p_S;
}

// The share of the whole error that nobody stated is the same along every axis.
Matrix3 Engine::row_covariance(const std::array<float, 6>& relative) const {
  const double share = std::min(1.0, stated_variance_ / scales_.sigma_squared);
  return (1 - share) * Matrix3::Identity() + share * symmetric(relative);
}

Matrix3 Engine::precision(const FitRow& row) const {
  if (uniform_) return Matrix3::Identity();
  if (row.is_range()) return row.p_S * row.p_S.transpose() / row_covariance(row.relative)(0, 0);
  return row_covariance(row.relative).inverse();
}

double Engine::whitened_squares(const FitRow& row) const {
  if (uniform_) return row.residual.squaredNorm();
  return row.residual.dot(precision(row) * row.residual);
}

double Engine::cost() const {
  double squares = 0;
  for (const FitRow& row : rows_) {
    if (!row.held_out && row.weight > 0) squares += row.weight * whitened_squares(row);
  }
  return squares / scales_.sigma_squared + prior_squares();
}

void Engine::move(double fraction) {
  const auto& step = work_.step;
  const Vector3 turn(fraction * step[0], fraction * step[1], fraction * step[2]);
  if (const double angle = turn.norm(); angle > 0) {
    model_.X_SB.R = rotation_about(turn / angle, angle) * model_.X_SB.R;
  }
  for (std::size_t c = 0; c < 6; ++c) base_moved_[c] += fraction * step[c];
  for (std::size_t c = 0; c < 3; ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    model_.X_SB.p[i] += fraction * step[3 + c];
    for (std::size_t t = 0; t < targets_.size(); ++t) {
      targets_[t].p_L[i] += fraction * step[target_column(t) + c];
    }
  }
  for (std::size_t j = 0; j < model_.joint_count(); ++j) {
    JointModel& joint = model_.joints[j];
    for (std::size_t c = 0; c < kDeviations; ++c) {
      joint.deviation[c] += fraction * step[joint_column(j) + c];
    }
    if (!maps_on_) continue;
    for (std::size_t k = 0; k < kKnots; ++k) joint.map[k] += fraction * work_.map_step[j][k];
  }
  for (std::size_t k = 0; k < model_.further.size(); ++k) {
    value_of(model_, model_.further[k]) += fraction * step[further_column() + k];
  }
  for (std::size_t t = 0; t < model_.gravity.size(); ++t) {
    model_.gravity[t].coefficient += fraction * step[gravity_column() + t];
  }
}

void Engine::improve(int passes) {
  work_.step.fill(0);
  for (MapCoefficients& step : work_.map_step) step.fill(0);
  factorise_geometry(true);
  const std::size_t n = model_.joint_count();
  improve_geometry();
  for (int pass = 0; maps_on_ && pass < passes; ++pass) {
    for (std::size_t j = 0; j < n; ++j) improve_map(j);
    for (std::size_t j = n - 1; j-- > 0;) improve_map(j);
    improve_geometry();
  }
}

// How far the steps of the blocks move the predictions, rms; before move().
double Engine::predicted_motion() {
  double squares = 0;
  double weights = 0;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const FitRow& row = rows_[k];
    if (row.held_out || row.weight == 0) continue;
    FitRow before = row;
    evaluate(before, frames_of(k));
    const Vector3 moved = before.residual - row.residual;
    // Per measured number, three of which are a position.
    squares +=
        row.weight * (row.is_range() ? 3 * std::pow(row.p_S.dot(moved), 2) : moved.squaredNorm());
    weights += row.weight;
  }
  return std::sqrt(squares / std::max(weights, 1.0));
}

// One step, as long as the cost allows. Returns how far it moves the predictions, rms.
double Engine::round(int passes) {
  assemble();
  const double before = cost();
  double moved = 0;
  for (int tries = 0; tries < kMostTries; ++tries) {
    improve(passes);
    moved = predicted_motion();
    move(1);
    const double expected = cost();  // of the linear model: residuals as improve() left them
    evaluate();
    const double after = cost();
    if (after <= before) {
      const double gain = (before - after) / std::max(before - expected, 1e-300);
      trust_ *= gain > kGoodGain ? 3 : gain < kPoorGain ? 0.5 : 1;
      return moved;
    }
    move(-1);
    evaluate();
    trust_ /= 5;
  }
  return moved;
}

void Engine::start() {
  summary_ = {};
  trust_ = 1;
  effective_ = 0;
  coarse_ = 0;
  base_moved_.fill(0);
  for (ModelTarget& target : targets_) {
    target.start_L = target.p_L;
    target.rows = 0;
  }
  if (!parts_.gravity) model_.gravity.clear();
  ARMSIG_CHECK(columns_ >= gravity_column() + model_.gravity.size());
  columns_ = gravity_column() + model_.gravity.size();
  evaluate();
  for (FitRow& row : rows_) {
    row.weight = 1;
    if (row.held_out) continue;
    ++summary_.rows;
    ++targets_[row.target].rows;
  }
  scales_.sigma_squared = 1;
  const double scale = residual_scale();
  scales_.sigma_squared = scale * scale;
}

Result<FitSummary> Engine::run(const ModelParts& parts) {
  parts_ = parts;
  start();
  if (summary_.rows == 0) return std::unexpected(Error::kTooFewPoints);
  bool harmless = false;
  for (int i = 0; i < kMostRounds && !harmless; ++i) {
    maps_on_ = parts_.maps && i > 0;
    if (i < kSoftRounds || coarse_ > kSettledScale * residual_scale()) {
      weigh_softly();
    } else {
      reject();
    }
    const double sigma_before = scales_.sigma_squared;
    const double moved = round(kPasses);
    update_scales();
    ++summary_.rounds;
    const double sigma = std::sqrt(scales_.sigma_squared);
    harmless = i + 1 >= kLeastRounds && moved < kHarmlessStep * sigma &&
               std::abs(std::log(scales_.sigma_squared / sigma_before)) < kHarmlessChange;
  }
  summary_.converged = harmless;
  reject();
  round(kLastPasses);
  update_scales();
  finish_covariance();
  summary_.degrees_of_model = effective_;
  if (!std::isfinite(scales_.sigma_squared)) return std::unexpected(Error::kSingular);
  return summary_;
}

}  // namespace armsig::calibration
