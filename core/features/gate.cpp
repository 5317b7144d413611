// SPDX-License-Identifier: MIT
#include "core/features/gate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

namespace armsig::features {
namespace {

using Coefficients = MotionRls::Coefficients;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kChiSquareMedian = 2.366;  // of 3 degrees of freedom
constexpr std::size_t kSubsets =
    64;  // with half of the points wrong, 64 triples miss with 2 in 10,000
constexpr int kMostRounds = 20;
// A point is judged alone once the prediction adds less than this to its variance.
constexpr double kMostPredictionVariance = 0.5;
// Below this a point is the only one that determines some coefficient: nothing can contradict it.
constexpr double kNoSpread = 1e-6;

// 3 times the 99.99 % quantile of F(3, freedom): the limit where the variance itself is estimated
// from so many residuals. Paulson's normal approximation of the cube root of F; infinite where
// there is too little to judge by.
double estimated_limit(double freedom) {
  if (freedom < 1) return kInfinity;
  constexpr double kNormal = 3.719;  // 99.99 % quantile of the normal distribution
  const double a = 2.0 / (9.0 * 3.0);
  const double b = 2.0 / (9.0 * freedom);
  // Solve (1 - b) f - (1 - a) = z sqrt(b f^2 + a) for the cube root f.
  const double z2 = kNormal * kNormal;
  const double qa = (1 - b) * (1 - b) - z2 * b;
  if (qa <= 0) return kInfinity;
  const double qb = (1 - b) * (1 - a);
  const double qc = (1 - a) * (1 - a) - z2 * a;
  const double f = (qb + std::sqrt(qb * qb - qa * qc)) / qa;
  return 3 * f * f * f;
}

// The prediction's variance at `point` over the variance of the point.
double leverage(const MotionRls& motion, const Vector3& regressors, const SweepPoint& point) {
  return motion.prediction_variance(regressors) / point.variance();
}

// r^T (variance_factor * covariance + rounding)^-1 r, with r the residual of the point.
double chi_square(const MotionStatistics& about, const Coefficients& fit, double variance_factor,
                  const SweepPoint& point) {
  const Vector3 r = point.p_S - about.origin_S - fit.transpose() * about.regressors(point);
  Matrix3 covariance = variance_factor * point.covariance_m2;
  covariance.diagonal().array() += rounding_variance(point, fit.row(1).norm());
  // Scaled, because variances of exact data are near 1e-30 and their determinant would underflow.
  const double size = covariance.trace();
  const Vector3 solved = (covariance / size).inverse() * r;
  return r.dot(solved) / size;
}

}  // namespace

GateScale gate_scale(const MotionStatistics& accepted, bool sigma_is_known) {
  const double freedom = accepted.motion_freedom();
  const double variance = freedom < 1 ? 0 : accepted.motion_chi_square() / freedom;
  // A stated sigma may be too small, by a factor that the residuals show; it is never made smaller.
  if (sigma_is_known) return {std::max(variance, 1.0), kGateChiSquare};
  // Where nothing was stated, a systematic error of drive or sensor can't be told from noise by its
  // size, and real ones reach five or six sigmas of the rest; outliers by a detour of the sound are
  // far beyond twice the distance.
  return {variance, 4 * estimated_limit(freedom)};
}

bool predicts(const MotionStatistics& accepted, const SweepPoint& point) {
  return accepted.count > 0 &&
         leverage(accepted.motion, accepted.regressors(point), point) < kMostPredictionVariance;
}

bool passes_gate(const MotionStatistics& accepted, bool sigma_is_known, const SweepPoint& point) {
  const Coefficients fit = accepted.motion.solve();
  const GateScale scale = gate_scale(accepted, sigma_is_known);
  return chi_square(accepted, fit, scale.variance, point) <=
         scale.limit * (1 + leverage(accepted.motion, accepted.regressors(point), point));
}

Judging::Judging(const MotionStatistics& accepted, bool sigma_is_known,
                 const WaitingPoints& waiting)
    : accepted_(accepted),
      waiting_(waiting),
      least_median_(kInfinity),
      least_cost_(kInfinity),
      sigma_is_known_(sigma_is_known) {
  if (waiting.empty()) {
    stage_ = Stage::kOver;
    return;
  }
  for (std::size_t i = 0; i < waiting.size(); ++i) order_.push_back(static_cast<std::uint8_t>(i));
  std::ranges::sort(order_, [&](std::uint8_t i, std::uint8_t j) {
    const SweepPoint& a = waiting[i];
    const SweepPoint& b = waiting[j];
    if (a.reading != b.reading) return a.reading < b.reading;
    return std::ranges::lexicographical_compare(a.p_S, b.p_S);
  });
  next_ = base();
  for (const std::uint8_t i : order_) {
    const double weight = 1 / std::sqrt(waiting[i].variance());
    rows_.push_back(weight * next_.regressors(waiting[i]));
  }
}

bool Judging::step() {
  switch (stage_) {
    case Stage::kMedians:
      try_median();
      return true;
    case Stage::kCosts:
      try_cost();
      return true;
    case Stage::kRounds:
      judge(count_);
      if (++count_ == order_.size()) end_round();
      break;
    case Stage::kOver:
      break;
  }
  return stage_ != Stage::kOver;
}

// The accepted statistics to build on; without any, empty ones about the middle of the waiting
// points, coordinate by coordinate, which no outlier can drag away.
MotionStatistics Judging::base() const {
  if (accepted_.count > 0) return accepted_;
  const std::size_t middle = waiting_.size() / 2;
  SweepPoint origin = waiting_[order_[middle]];
  Order order = order_;
  for (int axis = 0; axis < 3; ++axis) {
    const auto coordinate = [&](std::uint8_t i) { return waiting_[i].p_S[axis]; };
    std::ranges::nth_element(order, order.begin() + middle, {}, coordinate);
    origin.p_S[axis] = coordinate(order[middle]);
  }
  return {accepted_.type, origin};
}

Vector3 Judging::weighted_position(std::size_t row) const {
  return rows_[row][0] * (waiting_[order_[row]].p_S - next_.origin_S);
}

// A fit through the points accepted before and a minimal subset of the waiting ones: one from each
// third (half) of the range of readings, or, every second time, from anywhere, in case all those of
// one third are wrong.
MotionRls Judging::candidate() {
  const std::size_t rows = rows_.size();
  const std::size_t size = std::min(static_cast<std::size_t>(motion_unknowns(next_.type)), rows);
  MotionRls motion = next_.motion;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t begin = count_ % 2 == 0 ? i * rows / size : 0;
    const std::size_t end = count_ % 2 == 0 ? (i + 1) * rows / size : rows;
    const std::size_t row = begin + sequence_.below(end - begin);
    motion.update(rows_[row], weighted_position(row));
  }
  return motion;
}

// From a fit: quick, for ranking.
double Judging::squared_distance(std::size_t row, const Coefficients& fit) const {
  const double d = (weighted_position(row) - fit.transpose() * rows_[row]).squaredNorm();
  return std::isfinite(d) ? d : kInfinity;
}

// Least median of squares, then, at the scale that the median shows, the candidate that explains
// most (truncated squares): the median alone cannot tell candidates apart where more than half of
// the points share one reading.
void Judging::try_median() {
  const auto unknowns = static_cast<std::size_t>(motion_unknowns(next_.type));
  const std::size_t rows = rows_.size();
  const std::size_t middle = std::min(rows / 2 + (unknowns + 1) / 2, rows) - 1;
  const Coefficients fit = candidate().solve();
  FixedVector<double, kGateCapacity> distances;
  for (std::size_t i = 0; i < rows; ++i) distances.push_back(squared_distance(i, fit));
  std::nth_element(distances.begin(), distances.begin() + middle, distances.end());
  least_median_ = std::min(least_median_, distances[middle]);
  if (++count_ < kSubsets) return;

  // Rousseeuw's correction for few points.
  const double spare = static_cast<double>(rows) - static_cast<double>(unknowns);
  const double few = 1 + 5 / std::max(spare, 1.0);
  scale_ = {few * few * least_median_ / kChiSquareMedian, kGateChiSquare};
  if (sigma_is_known_) scale_.variance = std::max(scale_.variance, 1.0);
  motion_ = next_.motion;
  stage_ = Stage::kCosts;
  count_ = 0;
  sequence_ = {};
}

void Judging::try_cost() {
  const MotionRls motion = candidate();
  const Coefficients fit = motion.solve();
  double cost = 0;
  for (std::size_t i = 0; i < rows_.size(); ++i)
    cost += std::min(squared_distance(i, fit), kGateChiSquare * scale_.variance);
  if (cost < least_cost_) {
    least_cost_ = cost;
    motion_ = motion;
  }
  if (++count_ < kSubsets) return;
  stage_ = Stage::kRounds;
  begin_round();
}

void Judging::begin_round() {
  count_ = 0;
  changed_ = false;
  fit_ = motion_.solve();
}

void Judging::judge(std::size_t place) {
  const SweepPoint& point = waiting_[order_[place]];
  bool& verdict = verdicts_[order_[place]];
  // The residual of a point that took part in the fit is smaller than its noise, that of any other
  // is larger.
  const bool took_part = round_ > 0 && verdict;
  const double h = leverage(motion_, next_.regressors(point), point);
  const double spread = took_part ? 1 - h : 1 + h;
  const bool alone = took_part && spread < kNoSpread;
  const bool passes =
      alone || chi_square(next_, fit_, scale_.variance, point) <= scale_.limit * spread;
  changed_ = changed_ || passes != verdict;
  verdict = passes;
}

void Judging::end_round() {
  if (!changed_ || ++round_ == kMostRounds) {
    stage_ = Stage::kOver;
    return;
  }
  FixedVector<SweepPoint, MotionRls::kBlockRows> passed;
  for (const std::uint8_t i : order_) {
    if (verdicts_[i]) passed.push_back(waiting_[i]);
    if (!passed.full()) continue;
    next_.add(passed);
    passed.clear();
  }
  next_.add(passed);
  motion_ = next_.motion;
  scale_ = gate_scale(next_, sigma_is_known_);
  next_ = base();
  begin_round();
}

}  // namespace armsig::features
