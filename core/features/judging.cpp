// SPDX-License-Identifier: MIT
#include "core/features/judging.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numerics/quantiles.hpp"

namespace armsig::features {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kSubsets =
    64;  // with half of the points wrong, 64 triples miss with 2 in 10,000
constexpr int kMostRounds = 20;

}  // namespace

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
  for (std::size_t row = 0; row < order_.size(); ++row) {
    const SweepPoint& point = waiting[order_[row]];
    const double weight = 1 / std::sqrt(point.variance());
    const Vector3 x = weight * next_.regressors(point);
    const Vector3 p = weight * (point.p_S - next_.origin_S);
    for (int j = 0; j < 3; ++j) {
      columns_[j][row] = x[j];
      columns_[3 + j][row] = p[j];
    }
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

// A fit through the points accepted before and a minimal subset of the waiting ones: one from each
// third (half) of the range of readings, or, every second time, from anywhere, in case all those of
// one third are wrong.
MotionRls Judging::candidate() {
  const std::size_t rows = order_.size();
  const std::size_t size = std::min(static_cast<std::size_t>(motion_unknowns(next_.type)), rows);
  MotionRls motion = next_.motion;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t begin = count_ % 2 == 0 ? i * rows / size : 0;
    const std::size_t end = count_ % 2 == 0 ? (i + 1) * rows / size : rows;
    const std::size_t row = begin + sequence_.below(end - begin);
    const auto& c = columns_;
    motion.update({c[0][row], c[1][row], c[2][row]}, {c[3][row], c[4][row], c[5][row]});
  }
  return motion;
}

void Judging::squared_distances(const Coefficients& fit, Distances& distances) const {
  const auto& [x0, x1, x2, px, py, pz] = columns_;
  const std::array<const double*, 3> p = {px.data(), py.data(), pz.data()};
  for (std::size_t k = 0; k < order_.size(); ++k) {
    double squares = 0;
    for (int i = 0; i < 3; ++i) {
      const double d = p[i][k] - x0[k] * fit(0, i) - x1[k] * fit(1, i) - x2[k] * fit(2, i);
      squares += d * d;
    }
    distances[k] = squares < kInfinity ? squares : kInfinity;
  }
}

// Least median of squares, then, at the scale that the median shows, the candidate that explains
// most (truncated squares): the median alone cannot tell candidates apart where more than half of
// the points share one reading.
void Judging::try_median() {
  const auto unknowns = static_cast<std::size_t>(motion_unknowns(next_.type));
  const std::size_t rows = order_.size();
  const std::size_t middle = std::min(rows / 2 + (unknowns + 1) / 2, rows) - 1;
  const Coefficients fit = candidate().solve();
  Distances distances;
  squared_distances(fit, distances);
  std::nth_element(distances.begin(), distances.begin() + middle, distances.begin() + rows);
  least_median_ = std::min(least_median_, distances[middle]);
  if (++count_ < kSubsets) return;

  // Rousseeuw's correction for few points.
  const double spare = static_cast<double>(rows) - static_cast<double>(unknowns);
  const double few = 1 + 5 / std::max(spare, 1.0);
  scale_ = {few * few * least_median_ / numerics::kChiSquareMedian3, kGateChiSquare};
  if (sigma_is_known_) scale_.variance = std::max(scale_.variance, 1.0);
  motion_ = next_.motion;
  stage_ = Stage::kCosts;
  count_ = 0;
  sequence_ = {};
}

void Judging::try_cost() {
  const MotionRls motion = candidate();
  const Coefficients fit = motion.solve();
  Distances distances;
  squared_distances(fit, distances);
  const double most = kGateChiSquare * scale_.variance;
  double cost = 0;
  for (std::size_t i = 0; i < order_.size(); ++i) cost += std::min(distances[i], most);
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
  const bool took_part = round_ > 0 && verdict;
  const Vector3 x = next_.regressors(point);
  const double leverage = motion_.prediction_variance(x) / point.variance();
  // A residual that was fitted is smaller than its noise, any other larger.
  const double spread = took_part ? 1 - leverage : 1 + leverage;
  const Vector3 residual = point.p_S - next_.origin_S - fit_.transpose() * x;
  const bool passes =
      (took_part && spread < kNoSpread) || scale_.allows(residual, spread, point, fit_);
  changed_ = changed_ || passes != verdict;
  verdict = passes;
}

void Judging::end_round() {
  if (!changed_ || ++round_ == kMostRounds) {
    stage_ = Stage::kOver;
    return;
  }
  for (const std::uint8_t i : order_)
    if (verdicts_[i]) next_.add(waiting_[i]);
  motion_ = next_.motion;
  scale_ = gate_scale(next_, sigma_is_known_);
  next_ = base();
  begin_round();
}

}  // namespace armsig::features
