// SPDX-License-Identifier: MIT
#include "core/calibration/half_play.hpp"

#include <cmath>
#include <limits>

#include "core/numerics/cholesky.hpp"

namespace armsig::calibration {
namespace {

// Information [1/rad^2 or 1/m^2] that says nothing: of a radian, or a metre.
constexpr double kLeastInformation = 1;

}  // namespace

double HalfPlay::squared() const { return is_seen() ? value * value - sigma * sigma : 0; }

HalfPlays half_plays(const PlayBlock& found, std::size_t joints) {
  // Symmetric but for what the other unknowns had still to go.
  const PlayBlock::Square told = (found.told + found.told.transpose()) / 2;
  PlayBlock::Square factor = told + kLeastInformation * PlayBlock::Square::Identity();
  const bool tells = numerics::factor_positive(factor, kMaxJoints);
  HalfPlays halves;
  for (std::size_t i = 0; i < joints; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (!tells || !(told(k, k) > kLeastInformation)) {
      halves.push_back({0, std::numeric_limits<double>::infinity()});
      continue;
    }
    PlayBlock::Numbers row = PlayBlock::Numbers::Unit(k);  // of the covariance
    numerics::solve_lower(factor, row, kMaxJoints);
    const double variance = row.squaredNorm();
    numerics::solve_lower_transposed(factor, row, kMaxJoints);
    halves.push_back({found.half(k) + row.dot(found.gradient), std::sqrt(variance)});
  }
  return halves;
}

}  // namespace armsig::calibration
