// SPDX-License-Identifier: MIT
// Sigma and the scales of the priors, from the evidence of the rows; and what the fit leaves open.
#include <algorithm>
#include <cmath>

#include "core/calibration/engine.hpp"
#include "core/calibration/engine_detail.hpp"

namespace armsig::calibration {

namespace {

// Shares of the two fixed points, in logarithms: the one is quick, the other never overshoots.
constexpr double kQuick = 0.7;
constexpr double kLeastScale = 1e-6;
constexpr double kLargestScale = 1e6;
constexpr double kLeastFreedom = 0.05;
// What is known of a workshop before any row was seen counts as one unknown of the usual size: it
// matters where the rows say little, and a scale found from little alone is too small as often as
// it is too large, but only the former makes promises.
constexpr double kUsual = 1;

// One group of unknowns with a common prior scale.
struct Group {
  double squares = 0;  // x^T Q x
  double trace = 0;    // tr(Q C)
  double unknowns = 0;
};

// Updates the scale, `usual` unknowns of unit size counted in; returns how many of the unknowns the
// rows determine.
double update(const Group& group, double& scale, double usual = 0) {
  if (group.unknowns == 0) return 0;
  const double determined = std::clamp(group.unknowns - group.trace / scale, 1e-3, group.unknowns);
  const double squares = group.squares + usual;
  const double quick = std::max(squares, 1e-12) / (determined + usual);
  const double steady = std::max(squares + group.trace, 1e-12) / (group.unknowns + usual);
  scale = std::clamp(std::exp(kQuick * std::log(quick) + (1 - kQuick) * std::log(steady)),
                     kLeastScale, kLargestScale);
  return determined;
}

}  // namespace

double Engine::update_geometry_scales() {
  enum : std::size_t { kTurns, kShifts, kZeros, kReadings, kSags, kOpen };
  std::array<Group, 6> groups;
  factorise_geometry(false);
  std::array<double, kMaxGeometry> e{};
  for (std::size_t c = 0; c < columns_; ++c) {
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
    groups[group].squares += deviation(c) * deviation(c) / unit;
    groups[group].trace += variance / unit;
    groups[group].unknowns += 1;
  }
  Scales found = scales_;
  const double determined =
      update(groups[kTurns], found.rotation, kUsual) +
      update(groups[kShifts], found.shift, kUsual) + update(groups[kZeros], found.zero, kUsual) +
      update(groups[kReadings], scales_.reading) + update(groups[kSags], scales_.gravity) +
      groups[kOpen].unknowns - groups[kOpen].trace;
  if (!scales_.geometry_is_held) {
    scales_.rotation = found.rotation;
    scales_.shift = found.shift;
    scales_.zero = found.zero;
  }
  return determined;
}

double Engine::update_map_scales() {
  double determined = 0;
  const std::array<double, kSplines> prior = map_prior();
  CyclicBand covariance;
  for (std::size_t j = 0; j < model_.joint_count(); ++j) {
    work_.factor.factorise(work_.band[j], scales_.sigma_squared, prior, scales_.map[j]);
    work_.factor.inverse_band(covariance);
    Group group{.squares = map_prior_squares(model_.joints[j].map), .trace = 0, .unknowns = kKnots};
    for (const auto& row : covariance) {
      group.trace += prior[0] * static_cast<double>(row[0]);
      for (std::size_t k = 1; k < kSplines; ++k) {
        group.trace += 2 * prior[k] * static_cast<double>(row[k]);
      }
    }
    determined += update(group, scales_.map[j]);
  }
  return determined;
}

void Engine::update_scales() {
  effective_ = update_geometry_scales();
  if (maps_on_) effective_ += update_map_scales();
  double squares = 0;
  double weights = 0;
  for (const FitRow& row : rows_) {
    if (row.held_out || row.weight == 0) continue;
    squares += row.weight * whitened_squares(row);
    weights += static_cast<double>(row.scalars()) * row.weight;
  }
  const double freedom = std::max(weights - effective_, kLeastFreedom * weights);
  scales_.sigma_squared = std::max(kLeastVariance, squares / freedom);
}

// The band of the rows gives way to that of the covariance.
void Engine::finish_covariance() {
  factorise_geometry(false);
  for (std::size_t j = 0; j < model_.joint_count(); ++j) {
    if (!maps_on_) {
      work_.band[j] = {};
      continue;
    }
    work_.factor.factorise(work_.band[j], scales_.sigma_squared, map_prior(), scales_.map[j]);
    work_.factor.inverse_band(work_.band[j]);
    note_map_variance(j);
  }
}

// At the middle of every spline: b = (1, 4, 1) / 6 about its knot.
void Engine::note_map_variance(std::size_t joint) {
  const CyclicBand& C = work_.band[joint];
  for (std::size_t i = 0; i < kKnots; ++i) {
    const std::size_t before = (i + kKnots - 1) % kKnots;
    const std::size_t after = (i + 1) % kKnots;
    model_.joints[joint].map_variance[i] = (C[before][0] + 16 * C[i][0] + C[after][0] +
                                            8 * C[before][1] + 8 * C[i][1] + 2 * C[before][2]) /
                                           36;
  }
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
  return stated(J, frames, row.target, own);
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
