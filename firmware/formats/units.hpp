// SPDX-License-Identifier: MIT
// Units in the names of keys and columns: theta_deg, d_mm, air_c.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::tool {

enum class Dimension : std::uint8_t {
  kText,  // no number
  kNone,
  kInteger,
  kAngle,
  kLength,
  kTemperature,
  kTime,
  kAngularSpeed,
  kSpeed,
  kAngularAcceleration,
  kAcceleration,
};

// value_SI = value * multiply / divide; one of the two factors is 1. A length in millimetres is
// divided by 1000: one rounding; 0.001, which is no double, would make it two.
struct Unit {
  std::string_view suffix;
  double multiply = 1;
  double divide = 1;

  [[nodiscard]] constexpr double to_si(double value) const { return value * multiply / divide; }
};

// The units that a name of this dimension may end in; none for kText, kNone and kInteger.
[[nodiscard]] std::span<const Unit> units_of(Dimension dimension);

// "theta_deg", "theta_rad" for an angle called theta; the bare name where there is no unit.
[[nodiscard]] std::vector<std::string> names_of(std::string_view quantity, Dimension dimension);

// `value_si` in `unit`: the shortest text that reads back, times the unit, as `value_si` bit for
// bit; where rounding leaves none, the nearest.
[[nodiscard]] std::string text_in(const Unit& unit, double value_si);

inline constexpr Unit kDegree{"deg", kPi / 180.0, 1};
inline constexpr Unit kMillimetre{"mm", 1, 1000};

// Degrees or millimetres: what a reading of such a joint is written in.
[[nodiscard]] constexpr Unit unit_of(JointType type) {
  return type == JointType::kRevolute ? kDegree : kMillimetre;
}

[[nodiscard]] constexpr Dimension dimension_of(JointType type) {
  return type == JointType::kRevolute ? Dimension::kAngle : Dimension::kLength;
}

[[nodiscard]] constexpr std::string_view word_of(JointType type) {
  return type == JointType::kRevolute ? "revolute" : "prismatic";
}

// "rad" or "m": what a reading of such a joint is in.
[[nodiscard]] constexpr std::string_view si_suffix(JointType type) {
  return type == JointType::kRevolute ? "rad" : "m";
}

}  // namespace armsig::tool
