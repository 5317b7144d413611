// SPDX-License-Identifier: MIT
#include "core/features/gate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <Eigen/LU>

namespace armsig::features {
namespace {

using Coefficients = MotionRls::Coefficients;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kChiSquareMedian = 2.366;  // of 3 degrees of freedom
constexpr int kSubsets = 64;  // with half of the points wrong, 64 triples miss with 2 in 10,000
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

Vector3 residual(const SweepStatistics& about, const Coefficients& fit, const SweepPoint& point) {
  return point.p_S - about.origin_S - fit.transpose() * about.regressors(point);
}

// Squared residual over the variance per axis: quick, for ranking.
double squared_distance(const SweepStatistics& about, const Coefficients& fit,
                        const SweepPoint& point) {
  const double d = residual(about, fit, point).squaredNorm() / point.variance();
  return std::isfinite(d) ? d : kInfinity;
}

// The prediction's variance at `point` over the variance of the point.
double leverage(const SweepStatistics& accepted, const SweepPoint& point) {
  return accepted.motion.prediction_variance(accepted.regressors(point)) / point.variance();
}

// r^T (variance_factor * covariance + rounding)^-1 r
double chi_square(const SweepPoint& point, const Vector3& r, double variance_factor, double speed) {
  Matrix3 covariance = variance_factor * point.covariance_m2;
  covariance.diagonal().array() += rounding_variance(point, speed);
  // Scaled, because variances of exact data are near 1e-30 and their determinant would underflow.
  const double size = covariance.trace();
  const Vector3 solved = (covariance / size).inverse() * r;
  return r.dot(solved) / size;
}

// Small deterministic generator (linear congruential, Knuth's MMIX constants): the same sweep
// always gets the same subsets.
class Sequence {
 public:
  std::size_t below(std::size_t bound) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<std::size_t>((state_ >> 33U) % bound);
  }

 private:
  std::uint64_t state_ = 1;
};

using Order = std::array<std::uint8_t, kGateCapacity>;

// Indices of the waiting points by ascending reading.
Order by_reading(const WaitingPoints& waiting) {
  Order order{};
  for (std::size_t i = 0; i < waiting.size(); ++i) order[i] = static_cast<std::uint8_t>(i);
  std::sort(order.begin(), order.begin() + waiting.size(), [&](std::uint8_t a, std::uint8_t b) {
    if (waiting[a].reading != waiting[b].reading) return waiting[a].reading < waiting[b].reading;
    return std::lexicographical_compare(waiting[a].p_S.begin(), waiting[a].p_S.end(),
                                        waiting[b].p_S.begin(), waiting[b].p_S.end());
  });
  return order;
}

// The accepted statistics to build on; without any, empty ones about the middle of the waiting
// points, coordinate by coordinate, which no outlier can drag away.
SweepStatistics base(const SweepStatistics& accepted, const WaitingPoints& waiting,
                     const Order& order) {
  if (accepted.count > 0) return accepted;
  const std::size_t middle = waiting.size() / 2;
  SweepPoint origin = waiting[order[middle]];
  for (int axis = 0; axis < 3; ++axis) {
    std::array<double, kGateCapacity> values{};
    for (std::size_t i = 0; i < waiting.size(); ++i) values[i] = waiting[i].p_S[axis];
    std::nth_element(values.begin(), values.begin() + middle, values.begin() + waiting.size());
    origin.p_S[axis] = values[middle];
  }
  return {accepted.type, origin};
}

// A fit through the points accepted before and a minimal subset of the waiting ones: one from each
// third (half) of the range of readings, or, every second time, from anywhere, in case all those of
// one third are wrong.
MotionRls candidate(const SweepStatistics& before, const WaitingPoints& waiting, const Order& order,
                    int trial, Sequence& sequence) {
  const std::size_t size =
      std::min(static_cast<std::size_t>(motion_unknowns(before.type)), waiting.size());
  MotionRls motion = before.motion;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t begin = trial % 2 == 0 ? i * waiting.size() / size : 0;
    const std::size_t end = trial % 2 == 0 ? (i + 1) * waiting.size() / size : waiting.size();
    const SweepPoint& point = waiting[order[begin + sequence.below(end - begin)]];
    const double weight = 1 / std::sqrt(point.variance());
    motion.update(weight * before.regressors(point), weight * (point.p_S - before.origin_S));
  }
  return motion;
}

struct RobustStart {
  MotionRls motion;
  double variance = 0;  // by which the points' covariances are multiplied
};

// Least median of squares, then, at the scale that the median shows, the candidate that explains
// most (truncated squares): the median alone cannot tell candidates apart where more than half of
// the points share one reading.
RobustStart robust_start(const SweepStatistics& before, const WaitingPoints& waiting,
                         const Order& order, bool sigma_is_known) {
  const std::size_t unknowns = static_cast<std::size_t>(motion_unknowns(before.type));
  const std::size_t middle = std::min(waiting.size() / 2 + (unknowns + 1) / 2, waiting.size()) - 1;
  double least_median = kInfinity;
  Sequence medians;
  for (int trial = 0; trial < kSubsets; ++trial) {
    const Coefficients fit = candidate(before, waiting, order, trial, medians).solve();
    std::array<double, kGateCapacity> distances{};
    for (std::size_t i = 0; i < waiting.size(); ++i)
      distances[i] = squared_distance(before, fit, waiting[i]);
    std::nth_element(distances.begin(), distances.begin() + middle,
                     distances.begin() + waiting.size());
    least_median = std::min(least_median, distances[middle]);
  }
  // Rousseeuw's correction for few points.
  const double spare = static_cast<double>(waiting.size()) - static_cast<double>(unknowns);
  const double few = 1 + 5 / std::max(spare, 1.0);
  RobustStart start{before.motion, few * few * least_median / kChiSquareMedian};
  if (sigma_is_known) start.variance = std::max(start.variance, 1.0);

  double least_cost = kInfinity;
  Sequence costs;
  for (int trial = 0; trial < kSubsets; ++trial) {
    const MotionRls motion = candidate(before, waiting, order, trial, costs);
    const Coefficients fit = motion.solve();
    double cost = 0;
    for (std::size_t i = 0; i < waiting.size(); ++i)
      cost += std::min(squared_distance(before, fit, waiting[i]), kGateChiSquare * start.variance);
    if (cost < least_cost) {
      least_cost = cost;
      start.motion = motion;
    }
  }
  return start;
}

}  // namespace

GateScale gate_scale(const SweepStatistics& accepted, bool sigma_is_known) {
  const double freedom = accepted.motion_freedom();
  const double variance = freedom < 1 ? 0 : accepted.motion_chi_square() / freedom;
  // A stated sigma may be too small, by a factor that the residuals show; it is never made smaller.
  if (sigma_is_known) return {std::max(variance, 1.0), kGateChiSquare};
  return {variance, estimated_limit(freedom)};
}

bool predicts(const SweepStatistics& accepted, const SweepPoint& point) {
  return accepted.count > 0 && leverage(accepted, point) < kMostPredictionVariance;
}

bool passes_gate(const SweepStatistics& accepted, bool sigma_is_known, const SweepPoint& point) {
  const Coefficients fit = accepted.motion.solve();
  const GateScale scale = gate_scale(accepted, sigma_is_known);
  const double d =
      chi_square(point, residual(accepted, fit, point), scale.variance, fit.row(1).norm());
  return d <= scale.limit * (1 + leverage(accepted, point));
}

Verdicts judge_together(const SweepStatistics& accepted, bool sigma_is_known,
                        const WaitingPoints& waiting) {
  Verdicts verdicts{};
  if (waiting.empty()) return verdicts;
  const Order order = by_reading(waiting);
  const SweepStatistics before = base(accepted, waiting, order);
  const RobustStart start = robust_start(before, waiting, order, sigma_is_known);

  SweepStatistics current = before;
  current.motion = start.motion;
  GateScale scale{start.variance, kGateChiSquare};
  for (int round = 0; round < kMostRounds; ++round) {
    const Coefficients fit = current.motion.solve();
    SweepStatistics next = before;
    bool changed = false;
    for (std::size_t i = 0; i < waiting.size(); ++i) {
      const SweepPoint& point = waiting[order[i]];
      bool& verdict = verdicts[order[i]];
      // The residual of a point that took part in the fit is smaller than its noise, that of any
      // other is larger.
      const bool took_part = round > 0 && verdict;
      const double h = leverage(current, point);
      const double spread = took_part ? 1 - h : 1 + h;
      const double d =
          chi_square(point, residual(current, fit, point), scale.variance, fit.row(1).norm());
      const bool alone = took_part && spread < kNoSpread;
      const bool passes = alone || d <= scale.limit * spread;
      changed = changed || passes != verdict;
      verdict = passes;
      if (passes) next.add(point);
    }
    if (!changed) break;
    current = next;
    scale = gate_scale(current, sigma_is_known);
  }
  return verdicts;
}

}  // namespace armsig::features
