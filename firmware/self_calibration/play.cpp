// SPDX-License-Identifier: MIT
#include "firmware/self_calibration/play.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

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
  const Eigen::LLT<Square> factor(told + kLeastInformation * Square::Identity());
  const Numbers h = found.half + factor.solve(found.gradient);
  HalfPlays halves;
  for (std::size_t i = 0; i < joints; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (!(told(k, k) > kLeastInformation)) {
      halves.push_back({0, std::numeric_limits<double>::infinity()});
      continue;
    }
    const Numbers unit = Numbers::Unit(k);
    const Numbers column = factor.solve(unit);
    halves.push_back({h(k), std::sqrt(std::max(column(k), 0.0))});
  }
  return halves;
}

}  // namespace armsig::controller
