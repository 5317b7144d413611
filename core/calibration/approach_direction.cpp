// SPDX-License-Identifier: MIT
#include "core/calibration/approach_direction.hpp"

#include <cmath>

namespace armsig::calibration {
namespace {

// Further than any backlash, and no more than a held joint's reading wanders.
constexpr double kMovesAngle = radians(0.3);
constexpr double kMovesLength = 0.5e-3;
constexpr double kStandsAngle = radians(0.01);
constexpr double kStandsLength = 0.02e-3;

}  // namespace

void ApproachDirection::go_to(const JointTypes& types, const JointVector& readings) {
  for (std::size_t i = 0; i < last_.size(); ++i) {
    const bool turns = types[i] == JointType::kRevolute;
    const double way = readings[i] - last_[i];
    if (std::abs(way) < (turns ? kStandsAngle : kStandsLength)) continue;
    const auto bit = static_cast<std::uint8_t>(1U << i);
    const bool known = std::abs(way) >= (turns ? kMovesAngle : kMovesLength);
    sided_ = static_cast<std::uint8_t>(known ? sided_ | bit : sided_ & ~bit);
    sides_ = static_cast<std::uint8_t>(way > 0 ? sides_ | bit : sides_ & ~bit);
  }
  last_ = readings;
}

}  // namespace armsig::calibration
