// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/coverage.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace armsig::tool {
namespace {

constexpr double kStep = 5e-3;
constexpr double kLongest = 100;
// Of an octant of directions: the error is as likely in all eight.
constexpr std::size_t kDirections = 32;
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

// Squares of the components of each direction.
std::array<Vector3, kDirections * kDirections> directions() {
  std::array<Vector3, kDirections * kDirections> squares;
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double z = (static_cast<double>(i) + 0.5) / kDirections;
    for (std::size_t j = 0; j < kDirections; ++j) {
      const double angle = kPi / 2 * (static_cast<double>(j) + 0.5) / kDirections;
      const double x2 = (1 - z * z) * std::cos(angle) * std::cos(angle);
      const double y2 = (1 - z * z) * std::sin(angle) * std::sin(angle);
      squares[i * kDirections + j] = {x2, y2, z * z};
    }
  }
  return squares;
}

// The error is its unit length times its direction u, independent of each other: its own length is
// that unit length times sqrt(u^T V u), which no length asked for changes.
class Spread {
 public:
  explicit Spread(const Vector3& variances) {
    static const auto squares = directions();
    for (std::size_t k = 0; k < squares.size(); ++k) {
      const double variance = squares[k].x() * variances.x() + squares[k].y() * variances.y() +
                              squares[k].z() * variances.z();
      sigma_[k] = variance > 0 ? std::sqrt(variance) : 0;
    }
  }

  [[nodiscard]] double probability_below(const UnitLength& unit, double length) const {
    double sum = 0;
    for (const double sigma : sigma_) sum += sigma > 0 ? unit.probability_below(length / sigma) : 1;
    return sum / static_cast<double>(sigma_.size());
  }

 private:
  std::array<double, kDirections * kDirections> sigma_{};
};

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

double probability_below(const UnitLength& unit, const Vector3& variances, double length) {
  return Spread(variances).probability_below(unit, length);
}

double coverage_length(const UnitLength& unit, std::span<const Vector3> variances,
                       double probability) {
  const std::vector<Spread> spreads(variances.begin(), variances.end());
  double upper = 0;
  for (const Vector3& each : variances) upper = std::max(upper, each.maxCoeff());
  upper = kLongest * std::sqrt(upper);
  double lower = 0;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = (lower + upper) / 2;
    double sum = 0;
    for (const Spread& each : spreads) sum += each.probability_below(unit, middle);
    (sum < probability * static_cast<double>(variances.size()) ? lower : upper) = middle;
  }
  return upper;
}

}  // namespace armsig::tool
