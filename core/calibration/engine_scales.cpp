// SPDX-License-Identifier: MIT
// Sigma and the scales of the priors, from the evidence of the rows; and what the fit leaves open.
#include <algorithm>
#include <cmath>

#include "core/calibration/engine.hpp"
#include "core/calibration/engine_detail.hpp"
#include "core/calibration/prior_scale.hpp"

namespace armsig::calibration {

namespace {

constexpr double kLeastFreedom = 0.05;
}  // namespace

void Engine::begin_scales() {
  proximal_ = false;
  holding_ = true;
  groups_ = {};
  agenda_.put({factorisation(),
               {&Engine::add_variances, columns_, columns_ * columns_ / 2},
               &Engine::conclude_geometry_scales,
               {&Engine::scale_play, 2 * kPlayFactor},
               &Engine::begin_map_scales,
               of_rows(&Engine::add_errors, kLook),
               &Engine::conclude_sigma});
}

void Engine::add_variances(Units columns) {
  std::array<double, kMaxGeometry> e{};
  for (std::size_t c = columns.first; c < columns.last; ++c) {
    if (is_held(c)) continue;
    std::fill_n(e.begin(), columns_, 0.0);
    e[c] = 1;
    solve_lower(e, c);
    double variance = 0;
    for (std::size_t i = c; i < columns_; ++i) variance += e[i] * e[i];
    std::size_t group = kOpen;
    double scale = 1;
    if (c >= gravity_column()) {
      group = kSags;
      scale = scales_.gravity;
    } else if (c >= further_column()) {
      if (of_reading(model_.further[c - further_column()])) {
        group = kReadings;
        scale = scales_.reading;
      }
    } else if (c >= joint_column(0)) {
      const std::size_t kind = (c - joint_column(0)) % kDeviations;
      group = kind < 2 ? kTurns : kind < 4 ? kShifts : kZeros;
      scale = kind < 2 ? scales_.rotation : kind < 4 ? scales_.shift : scales_.zero;
    }
    const double unit = prior_variance(c) / scale;
    groups_[group].squares += deviation(c) * deviation(c) / unit;
    groups_[group].trace += variance / unit;
    groups_[group].unknowns += 1;
  }
}

void Engine::conclude_geometry_scales() {
  Scales found = scales_;
  effective_ = update_scale(groups_[kTurns], found.rotation, kUsualUnknowns) +
               update_scale(groups_[kShifts], found.shift, kUsualUnknowns) +
               update_scale(groups_[kZeros], found.zero, kUsualUnknowns) +
               update_scale(groups_[kReadings], scales_.reading) +
               update_scale(groups_[kSags], scales_.gravity) + groups_[kOpen].unknowns -
               groups_[kOpen].trace;
  if (scales_.geometry_is_held) return;
  scales_.rotation = found.rotation;
  scales_.shift = found.shift;
  scales_.zero = found.zero;
}

void Engine::scale_play() {
  if (play_on_) effective_ += update_scale(play_group(), scales_.play);
}

void Engine::begin_map_scales() {
  if (!maps_on_) return;
  joint_ = 0;
  maps_determined_ = 0;
  scale_next_map();
}

void Engine::scale_next_map() {
  while (joint_ < model_.joint_count() && !has_map(joint_)) ++joint_;
  if (joint_ == model_.joint_count()) {
    effective_ += maps_determined_;
    return;
  }
  work_.factor.factorise(work_.band[joint_], scales_.sigma_squared, map_prior(),
                         scales_.map[joint_]);
  agenda_.put({{&Engine::invert_map, kMapFactor},
               &Engine::conclude_map_scale,
               {&Engine::scale_next_map, kMapFactor}});
}

// Of the map that was factorised.
void Engine::invert_map() { work_.factor.invert(work_.covariance); }

void Engine::conclude_map_scale() {
  const std::array<double, kSplines> prior = map_prior();
  PriorGroup group{
      .squares = map_prior_squares(model_.joints[joint_].map), .trace = 0, .unknowns = kKnots};
  for (const auto& row : work_.covariance) {
    group.trace += prior[0] * static_cast<double>(row[0]);
    for (std::size_t k = 1; k < kSplines; ++k) {
      group.trace += 2 * prior[k] * static_cast<double>(row[k]);
    }
  }
  maps_determined_ += update_scale(group, scales_.map[joint_++]);
}

void Engine::add_errors(Units rows) {
  if (rows.first == 0) sums_ = {};
  for (const FitRow& row : rows_.subspan(rows.first, rows.last - rows.first)) {
    if (row.held_out || row.weight == 0) continue;
    sums_.squares += row.weight * whitened_squares(row);
    sums_.weights += static_cast<double>(row.scalars()) * row.weight;
  }
}

void Engine::conclude_sigma() {
  const double freedom = std::max(sums_.weights - effective_, kLeastFreedom * sums_.weights);
  scales_.sigma_squared = std::max(kLeastVariance, sums_.squares / freedom);
}

// The band of the rows gives way to that of the covariance.
void Engine::begin_covariance() {
  proximal_ = false;
  holding_ = false;
  joint_ = 0;
  agenda_.put({factorisation(), {&Engine::cover_play, kPlayFactor}, &Engine::cover_next_map});
  // Where the last step was a long one, a matrix of the place before it takes what no row tells for
  // what they all do.
  if (play_on_) put_assembly();
}

void Engine::cover_next_map() {
  if (!maps_on_) {
    for (std::size_t j = 0; j < model_.joint_count(); ++j) work_.band[j] = {};
    return;
  }
  while (joint_ < model_.joint_count() && !has_map(joint_)) leave_map_open();
  if (joint_ == model_.joint_count()) return;
  work_.factor.factorise(work_.band[joint_], scales_.sigma_squared, map_prior(),
                         scales_.map[joint_]);
  agenda_.put({{&Engine::invert_map, kMapFactor},
               &Engine::note_map_variance,
               {&Engine::cover_next_map, kMapFactor}});
}

// The reading of a joint without a map errs as those of the others do.
void Engine::leave_map_open() {
  double scales = 0;
  double count = 0;
  for (std::size_t j = 0; j < model_.joint_count(); ++j) {
    if (!has_map(j)) continue;
    scales += scales_.map[j];
    count += 1;
  }
  work_.band[joint_] = {};
  model_.joints[joint_].map_variance.fill(count > 0 ? static_cast<float>(scales / count) : 0);
  ++joint_;
}

// At the middle of every spline: b = (1, 4, 1) / 6 about its knot.
void Engine::note_map_variance() {
  const CyclicBand& C = work_.band[joint_] = work_.covariance;
  for (std::size_t i = 0; i < kKnots; ++i) {
    const std::size_t before = (i + kKnots - 1) % kKnots;
    const std::size_t after = (i + 1) % kKnots;
    model_.joints[joint_].map_variance[i] = (C[before][0] + 16 * C[i][0] + C[after][0] +
                                             8 * C[before][1] + 8 * C[i][1] + 2 * C[before][2]) /
                                            36;
  }
  ++joint_;
}

Engine::Stated Engine::covariance_at(const ChainFrames& frames, std::size_t target,
                                     const std::array<float, 6>& relative) const {
  GeometryColumns J;
  fill(frames, target, J);
  return stated(J, frames, target, scales_.sigma_squared * row_covariance(relative));
}

Engine::Stated Engine::covariance_of(const FitRow& row, const ChainFrames& frames) const {
  GeometryColumns J;
  fill(row, frames, J);
  Matrix3 own = scales_.sigma_squared * row_covariance(row.relative);
  if (row.is_range()) own = own(0, 0) * Matrix3::Identity();
  Stated stated_of = stated(J, frames, row.target, own);
  stated_of.model += play_covariance(row, frames);
  return stated_of;
}

// J is used up.
Engine::Stated Engine::stated(GeometryColumns& J, const ChainFrames& frames, std::size_t target,
                              const Matrix3& row) const {
  Stated stated;
  stated.row = row;
  for (std::array<double, kMaxGeometry>& row_of_J : J.d) solve_lower(row_of_J, 0);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      double sum = 0;
      for (std::size_t c = 0; c < columns_; ++c) sum += J.d[a][c] * J.d[b][c];
      stated.model(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) = sum;
    }
  }
  const Vector3 p_S = frames.X_SL * targets_[target].p_L;
  for (std::size_t j = 0; maps_on_ && j < targets_[target].link; ++j) {
    const SplineSupport& at = frames.support[j];
    double variance = 0;
    for (std::size_t a = 0; a < kSplines; ++a) {
      for (std::size_t b = 0; b < kSplines; ++b) {
        variance +=
            at.weight[a] * at.weight[b] *
            static_cast<double>(work_.band[j][at.knot(std::min(a, b))][a > b ? a - b : b - a]);
      }
    }
    const bool revolute = model_.joints[j].type == JointType::kRevolute;
    const Vector3 motion =
        map_unit(model_.joints[j].type) * motion_of(revolute, frames.X_SJ[j], p_S);
    stated.model += variance * motion * motion.transpose();
    stated.maps[j] = variance * motion.squaredNorm();
  }
  return stated;
}

// The gravity terms are the last columns: the factor without them is a corner of the whole one.
void Engine::times_covariance(std::array<double, kMaxGeometry>& b) const {
  const std::size_t count = gravity_column();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= lower(i, k) * b[k];
    b[i] /= lower(i, i);
  }
  for (std::size_t i = count; i-- > 0;) {
    b[i] /= lower(i, i);
    for (std::size_t k = 0; k < i; ++k) b[k] -= lower(i, k) * b[i];
  }
}

}  // namespace armsig::calibration
