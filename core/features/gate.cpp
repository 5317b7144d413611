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

// The prediction's variance at `point` over the variance of the point.
double leverage(const MotionStatistics& accepted, const SweepPoint& point) {
  return accepted.motion.prediction_variance(accepted.regressors(point)) / point.variance();
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

// The waiting points by ascending reading, so that the order of the rows cannot matter.
using Order = FixedVector<std::uint8_t, kGateCapacity>;

Order by_reading(const WaitingPoints& waiting) {
  Order order;
  for (std::size_t i = 0; i < waiting.size(); ++i) order.push_back(static_cast<std::uint8_t>(i));
  std::ranges::sort(order, [&](std::uint8_t i, std::uint8_t j) {
    const SweepPoint& a = waiting[i];
    const SweepPoint& b = waiting[j];
    if (a.reading != b.reading) return a.reading < b.reading;
    return std::ranges::lexicographical_compare(a.p_S, b.p_S);
  });
  return order;
}

// The accepted statistics to build on; without any, empty ones about the middle of the waiting
// points, coordinate by coordinate, which no outlier can drag away.
MotionStatistics base(const MotionStatistics& accepted, const WaitingPoints& waiting,
                      const Order& order) {
  if (accepted.count > 0) return accepted;
  const std::size_t middle = waiting.size() / 2;
  SweepPoint origin = waiting[order[middle]];
  for (int axis = 0; axis < 3; ++axis) {
    FixedVector<double, kGateCapacity> values;
    for (const SweepPoint& point : waiting) values.push_back(point.p_S[axis]);
    std::nth_element(values.begin(), values.begin() + middle, values.end());
    origin.p_S[axis] = values[middle];
  }
  return {accepted.type, origin};
}

// A row of the motion fit, weighted to unit variance per axis.
struct Row {
  Vector3 regressors = Vector3::Zero();
  Vector3 p = Vector3::Zero();
};
using Rows = FixedVector<Row, kGateCapacity>;

Rows weighted_rows(const MotionStatistics& about, const WaitingPoints& waiting,
                   const Order& order) {
  Rows rows;
  for (const std::uint8_t i : order) {
    const double weight = 1 / std::sqrt(waiting[i].variance());
    rows.push_back(
        {weight * about.regressors(waiting[i]), weight * (waiting[i].p_S - about.origin_S)});
  }
  return rows;
}

// Squared distance from a fit: quick, for ranking.
double squared_distance(const Row& row, const Coefficients& fit) {
  const double d = (row.p - fit.transpose() * row.regressors).squaredNorm();
  return std::isfinite(d) ? d : kInfinity;
}

// A fit through the points accepted before and a minimal subset of the waiting ones: one from each
// third (half) of the range of readings, or, every second time, from anywhere, in case all those of
// one third are wrong.
MotionRls candidate(const MotionStatistics& before, const Rows& rows, int trial,
                    Sequence& sequence) {
  const std::size_t size =
      std::min(static_cast<std::size_t>(motion_unknowns(before.type)), rows.size());
  MotionRls motion = before.motion;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t begin = trial % 2 == 0 ? i * rows.size() / size : 0;
    const std::size_t end = trial % 2 == 0 ? (i + 1) * rows.size() / size : rows.size();
    const Row& row = rows[begin + sequence.below(end - begin)];
    motion.update(row.regressors, row.p);
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
RobustStart robust_start(const MotionStatistics& before, const Rows& rows, bool sigma_is_known) {
  const auto unknowns = static_cast<std::size_t>(motion_unknowns(before.type));
  const std::size_t middle = std::min(rows.size() / 2 + (unknowns + 1) / 2, rows.size()) - 1;
  double least_median = kInfinity;
  Sequence medians;
  for (int trial = 0; trial < kSubsets; ++trial) {
    const Coefficients fit = candidate(before, rows, trial, medians).solve();
    FixedVector<double, kGateCapacity> distances;
    for (const Row& row : rows) distances.push_back(squared_distance(row, fit));
    std::nth_element(distances.begin(), distances.begin() + middle, distances.end());
    least_median = std::min(least_median, distances[middle]);
  }
  // Rousseeuw's correction for few points.
  const double spare = static_cast<double>(rows.size()) - static_cast<double>(unknowns);
  const double few = 1 + 5 / std::max(spare, 1.0);
  RobustStart start{before.motion, few * few * least_median / kChiSquareMedian};
  if (sigma_is_known) start.variance = std::max(start.variance, 1.0);

  double least_cost = kInfinity;
  Sequence costs;
  for (int trial = 0; trial < kSubsets; ++trial) {
    const MotionRls motion = candidate(before, rows, trial, costs);
    const Coefficients fit = motion.solve();
    double cost = 0;
    for (const Row& row : rows)
      cost += std::min(squared_distance(row, fit), kGateChiSquare * start.variance);
    if (cost < least_cost) {
      least_cost = cost;
      start.motion = motion;
    }
  }
  return start;
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
  return accepted.count > 0 && leverage(accepted, point) < kMostPredictionVariance;
}

bool passes_gate(const MotionStatistics& accepted, bool sigma_is_known, const SweepPoint& point) {
  const Coefficients fit = accepted.motion.solve();
  const GateScale scale = gate_scale(accepted, sigma_is_known);
  return chi_square(accepted, fit, scale.variance, point) <=
         scale.limit * (1 + leverage(accepted, point));
}

Verdicts judge_together(const MotionStatistics& accepted, bool sigma_is_known,
                        const WaitingPoints& waiting) {
  Verdicts verdicts{};
  if (waiting.empty()) return verdicts;
  const Order order = by_reading(waiting);
  const MotionStatistics before = base(accepted, waiting, order);
  const RobustStart start =
      robust_start(before, weighted_rows(before, waiting, order), sigma_is_known);

  MotionStatistics current = before;
  current.motion = start.motion;
  GateScale scale{start.variance, kGateChiSquare};
  for (int round = 0; round < kMostRounds; ++round) {
    const Coefficients fit = current.motion.solve();
    MotionStatistics next = before;
    FixedVector<SweepPoint, MotionRls::kBlockRows> passed;
    bool changed = false;
    for (const std::uint8_t i : order) {
      const SweepPoint& point = waiting[i];
      bool& verdict = verdicts[i];
      // The residual of a point that took part in the fit is smaller than its noise, that of any
      // other is larger.
      const bool took_part = round > 0 && verdict;
      const double h = leverage(current, point);
      const double spread = took_part ? 1 - h : 1 + h;
      const bool alone = took_part && spread < kNoSpread;
      const bool passes =
          alone || chi_square(current, fit, scale.variance, point) <= scale.limit * spread;
      changed = changed || passes != verdict;
      verdict = passes;
      if (passes) passed.push_back(point);
      if (!passed.full()) continue;
      next.add(passed);
      passed.clear();
    }
    if (!changed) break;
    next.add(passed);
    current = next;
    scale = gate_scale(current, sigma_is_known);
  }
  return verdicts;
}

}  // namespace armsig::features
