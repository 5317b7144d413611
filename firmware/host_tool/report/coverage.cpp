// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/coverage.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::tool {
namespace {

constexpr double kStep = 5e-3;
constexpr double kLongest = 100;
// Of an octant of directions: the error is as likely in all eight.
constexpr int kDirections = 32;
constexpr int kHalvings = 48;

// Density of the length in three directions, but for its constant.
double shape_at(double length, double freedom) {
  const double square = length * length;
  if (!(freedom > 0)) return square * std::exp(-square / 2);
  return square * std::exp(-(freedom + 3) / 2 * std::log1p(square / freedom));
}

double constant_of(double freedom) {
  if (!(freedom > 0)) return std::sqrt(2 / kPi);
  return 4 / std::sqrt(kPi) / std::pow(freedom, 1.5) *
         std::exp(std::lgamma((freedom + 3) / 2) - std::lgamma(freedom / 2));
}

}  // namespace

UnitLength::UnitLength(double freedom) {
  const double constant = constant_of(freedom);
  const auto steps = static_cast<std::size_t>(kLongest / kStep);
  probabilities_.assign(1, 0.0);
  double sum = 0;
  for (std::size_t k = 0; k < steps; ++k) {
    const double at = kStep * static_cast<double>(k);
    sum += constant * kStep / 6 *
           (shape_at(at, freedom) + 4 * shape_at(at + kStep / 2, freedom) +
            shape_at(at + kStep, freedom));
    probabilities_.push_back(std::min(1.0, sum));
  }
}

double UnitLength::probability_below(double length) const {
  if (length <= 0) return 0;
  const double place = length / kStep;
  const auto last = static_cast<double>(probabilities_.size() - 1);
  if (place >= last) return probabilities_.back();
  const auto below = static_cast<std::size_t>(place);
  const double share = place - std::floor(place);
  return (1 - share) * probabilities_[below] + share * probabilities_[below + 1];
}

// The error is its unit length times its direction u, independent of each other: its own length is
// that unit length times sqrt(u^T V u).
double probability_below(const UnitLength& unit, const Vector3& variances, double length) {
  double sum = 0;
  for (int i = 0; i < kDirections; ++i) {
    const double z = (i + 0.5) / kDirections;
    for (int j = 0; j < kDirections; ++j) {
      const double angle = kPi / 2 * (j + 0.5) / kDirections;
      const double x2 = (1 - z * z) * std::cos(angle) * std::cos(angle);
      const double y2 = (1 - z * z) * std::sin(angle) * std::sin(angle);
      const double variance = x2 * variances.x() + y2 * variances.y() + z * z * variances.z();
      sum += variance > 0 ? unit.probability_below(length / std::sqrt(variance)) : 1;
    }
  }
  return sum / (kDirections * kDirections);
}

double coverage_length(const UnitLength& unit, std::span<const Vector3> variances,
                       double probability) {
  double upper = 0;
  for (const Vector3& each : variances) upper = std::max(upper, each.maxCoeff());
  upper = kLongest * std::sqrt(upper);
  double lower = 0;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = (lower + upper) / 2;
    double sum = 0;
    for (const Vector3& each : variances) sum += probability_below(unit, each, middle);
    (sum < probability * static_cast<double>(variances.size()) ? lower : upper) = middle;
  }
  return upper;
}

}  // namespace armsig::tool
