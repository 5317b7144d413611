// SPDX-License-Identifier: MIT
#include "firmware/self_calibration/play.hpp"

#include <cmath>
#include <limits>

#include "core/numerics/cholesky.hpp"

namespace armsig::controller {
namespace {

using Numbers = calibration::PlayBlock::Numbers;
using Square = calibration::PlayBlock::Square;

// Information [1/rad^2 or 1/m^2] that says nothing: of a radian, or a metre.
constexpr double kLeastInformation = 1;

}  // namespace

double HalfPlay::squared() const { return is_seen() ? value * value - sigma * sigma : 0; }

HalfPlays half_plays(const calibration::PlayBlock& found, std::size_t joints) {
  // Symmetric but for what the other unknowns had still to go.
  const Square told = (found.told + found.told.transpose()) / 2;
  Square factor = told + kLeastInformation * Square::Identity();
  const bool tells = numerics::factor_positive(factor, kMaxJoints);
  HalfPlays halves;
  for (std::size_t i = 0; i < joints; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (!tells || !(told(k, k) > kLeastInformation)) {
      halves.push_back({0, std::numeric_limits<double>::infinity()});
      continue;
    }
    Numbers row = Numbers::Unit(k);  // of the covariance
    numerics::solve_lower(factor, row, kMaxJoints);
    const double variance = row.squaredNorm();
    numerics::solve_lower_transposed(factor, row, kMaxJoints);
    halves.push_back({found.half(k) + row.dot(found.gradient), std::sqrt(variance)});
  }
  return halves;
}

}  // namespace armsig::controller
