// SPDX-License-Identifier: MIT
#include "firmware/self_calibration/repeats.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/numerics/quantiles.hpp"

namespace armsig::controller {
namespace {

constexpr int kRounds = 12;
constexpr double kFiner = 8;            // by which the limit of a wrong point comes down in a round
constexpr double kUndetermined = 1e-9;  // of the parameters' information, so that each has some

double median_of(FixedVector<double, Repeats::kMost> numbers) {
  // By insertion: they are few.
  for (auto at = numbers.begin(); at != numbers.end(); ++at) {
    std::rotate(std::upper_bound(numbers.begin(), at, *at), at, at + 1);
  }
  const std::size_t half = numbers.size() / 2;
  return numbers.size() % 2 == 1 ? numbers[half] : (numbers[half - 1] + numbers[half]) / 2;
}

}  // namespace

void Repeats::add(const Matrix3& R_SL, const Vector3& difference_S, double variance_m2,
                  const Motions& by_load) {
  One one{.difference_S = difference_S, .variance_m2 = variance_m2, .by_load = by_load};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    one.by_target.push_back(R_SL.col(axis));
    one.by_sensor.push_back(Vector3::Unit(axis));
  }
  all_.push_back(one);
}

Vector3 Repeats::One::moved(Motions One::* cause, const numerics::Column& by) const {
  const Motions& motions = this->*cause;
  Vector3 moved = Vector3::Zero();
  for (std::size_t i = 0; i < motions.size(); ++i) {
    moved += by(static_cast<Eigen::Index>(i)) * motions[i];
  }
  return moved;
}

// One step of reweighted least squares: a pose whose square is the limit weighs a quarter.
bool Repeats::solve(Motions One::* cause, double limit, const Numbers& squares,
                    numerics::Column& by) const {
  numerics::Square information = numerics::Square::Zero();
  by.setZero();
  for (std::size_t p = 0; p < all_.size(); ++p) {
    const Motions& motions = all_[p].*cause;
    const double share = limit / (limit + squares[p]);
    const double weight = share * share / all_[p].variance_m2;
    for (std::size_t i = 0; i < motions.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      by(row) += weight * motions[i].dot(all_[p].difference_S);
      for (std::size_t k = 0; k <= i; ++k) {
        information(row, static_cast<Eigen::Index>(k)) += weight * motions[i].dot(motions[k]);
      }
    }
  }
  const auto n = static_cast<Eigen::Index>((all_[0].*cause).size());
  information.diagonal().head(n).array() += kUndetermined * information.trace();
  return numerics::solve_positive(information, by, n);
}

// Least squares of the cause's parameters with the loss of Geman and McClure, whose limit comes
// down from where no point is wrong (graduated non-convexity: Yang, Antonante, Tzoumas and Carlone,
// 2020).
Repeats::Explained Repeats::explained_by(Motions One::* cause) const {
  const std::size_t count = (all_[0].*cause).size();
  if (count == 0) return {};
  numerics::Column by = numerics::Column::Zero();
  Numbers squares;  // of what is not explained, in sigmas
  const auto loss = [&] {
    double sum = 0;
    for (const double x : squares) sum += x * kOneInThousand / (x + kOneInThousand);
    return sum;
  };
  for (const One& one : all_) {
    squares.push_back(one.difference_S.squaredNorm() / one.variance_m2);
  }
  const double before = loss();
  double limit = *std::ranges::max_element(squares);
  for (int round = 0; round < kRounds; ++round) {
    if (!solve(cause, std::max(limit, kOneInThousand), squares, by)) return {};
    for (std::size_t p = 0; p < all_.size(); ++p) {
      const Vector3 left = all_[p].difference_S - all_[p].moved(cause, by);
      squares[p] = left.squaredNorm() / all_[p].variance_m2;
    }
    limit /= kFiner;
  }
  double moved_m2 = 0;
  for (const One& one : all_) moved_m2 += one.moved(cause, by).squaredNorm();
  const auto poses = static_cast<double>(all_.size());
  const double chance =
      numerics::chi_square_quantile(static_cast<double>(count), numerics::kFiveSigma);
  return {.beyond = before - loss() - chance,
          .by_m = std::sqrt(moved_m2 / poses),
          .left = static_cast<std::size_t>(
              std::ranges::count_if(squares, [](double x) { return x > kOneInThousand; }))};
}

Repeats::Change Repeats::change(double wrong, double least_m) const {
  if (all_.empty()) return {};
  Numbers beyond_m;
  for (const One& one : all_) {
    if (is_beyond_chance(one.difference_S, one.variance_m2)) {
      beyond_m.push_back(one.difference_S.norm());
    }
  }
  const double expected = static_cast<double>(all_.size()) * wrong;
  const double chance = expected + 4 * std::sqrt(expected * (1 - wrong)) + 1;
  const auto is_more_than_chance = [&](std::size_t poses) {
    return static_cast<double>(poses) > chance;
  };
  struct Cause {
    std::string_view what;
    Motions One::* motions;
  };
  constexpr std::array<Cause, 3> kCauses{
      {{"target", &One::by_target}, {"sensor", &One::by_sensor}, {"load", &One::by_load}}};
  Change change;
  double most = 0;
  for (const Cause& cause : kCauses) {
    const Explained explained = explained_by(cause.motions);
    if (explained.beyond <= most || explained.by_m <= least_m) continue;
    if (is_more_than_chance(explained.left)) continue;
    most = explained.beyond;
    change = {cause.what, explained.by_m};
  }
  if (!change.what.empty()) return change;
  const double by_m = beyond_m.empty() ? 0 : median_of(beyond_m);
  return is_more_than_chance(beyond_m.size()) && by_m > least_m ? Change{"arm", by_m} : Change{};
}

}  // namespace armsig::controller
