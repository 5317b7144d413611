// SPDX-License-Identifier: MIT
#include "core/calibration/engine.hpp"

#include <algorithm>
#include <cmath>

#include "core/calibration/engine_detail.hpp"
#include "core/numerics/rotations.hpp"

namespace armsig::calibration {

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
  ARMSIG_CHECK(work.band.size() >= model.joint_count());
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
  looked_up_ = false;
  evaluate_rows({0, rows_.size()});
}

void Engine::evaluate_rows(Units rows) {
  FixedLinks links;
  place_links(model_, links);
  for (std::size_t k = rows.first; k < rows.last; ++k) {
    FitRow& row = rows_[k];
    const ModelTarget& target = targets_[row.target];
    ChainFrames& frames = cache_.empty() ? scratch_ : cache_[k];
    if (!looked_up_) look_up(model_, row.readings, target.link, frames);
    place_chain(model_, links, target.link, frames);
    evaluate(row, frames);
  }
}

void Engine::evaluate(FitRow& row, const ChainFrames& frames) const {
  const Vector3 p_S = frames.X_SL * targets_[row.target].p_L + behind(row, frames);
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
  if (uniform_) {
    if constexpr (kMergesRows) return static_cast<double>(row.merged.count) * Matrix3::Identity();
    return Matrix3::Identity();
  }
  if (row.is_range()) return row.p_S * row.p_S.transpose() / row_covariance(row.relative)(0, 0);
  return row_covariance(row.relative).inverse();
}

double Engine::whitened_squares(const FitRow& row) const {
  if (uniform_) {
    const double squares = row.residual.squaredNorm();
    if constexpr (kMergesRows) return row.merged.count * squares + row.merged.scatter_m2;
    return squares;
  }
  return row.residual.dot(precision(row) * row.residual);
}

// Of the squares that add_costs() has summed.
double Engine::cost() const { return sums_.squares / scales_.sigma_squared + prior_squares(); }

void Engine::move(double fraction) {
  const auto& step = work_.step;
  const Vector3 turn(fraction * step[0], fraction * step[1], fraction * step[2]);
  model_.X_SB.R = numerics::rotation_by(turn) * model_.X_SB.R;
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
  if (play_on_) play_->half += fraction * play_->step;
  for (std::size_t k = 0; k < model_.further.size(); ++k) {
    value_of(model_, model_.further[k]) += fraction * step[further_column() + k];
  }
  for (std::size_t t = 0; t < model_.gravity.size(); ++t) {
    model_.gravity[t].coefficient += fraction * step[gravity_column() + t];
  }
}

}  // namespace armsig::calibration
