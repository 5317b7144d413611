// SPDX-License-Identifier: MIT
#include "firmware/formats/units.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

constexpr std::array<Unit, 2> kAngleUnits{{kDegree, {"rad", 1, 1}}};
constexpr std::array<Unit, 2> kLengthUnits{{kMillimetre, {"m", 1, 1}}};
constexpr std::array<Unit, 1> kTemperatureUnits{{{"c", 1, 1}}};
constexpr std::array<Unit, 2> kTimeUnits{{{"ms", 1, 1000}, {"s", 1, 1}}};
constexpr std::array<Unit, 2> kAngularSpeedUnits{
    {{"deg_per_s", kPi / 180.0, 1}, {"rad_per_s", 1, 1}}};
constexpr std::array<Unit, 2> kSpeedUnits{{{"mm_per_s", 1, 1000}, {"m_per_s", 1, 1}}};
constexpr std::array<Unit, 2> kAngularAccelerationUnits{
    {{"deg_per_s2", kPi / 180.0, 1}, {"rad_per_s2", 1, 1}}};
constexpr std::array<Unit, 2> kAccelerationUnits{{{"mm_per_s2", 1, 1000}, {"m_per_s2", 1, 1}}};

}  // namespace

std::span<const Unit> units_of(Dimension dimension) {
  switch (dimension) {
    case Dimension::kAngle:
      return kAngleUnits;
    case Dimension::kLength:
      return kLengthUnits;
    case Dimension::kTemperature:
      return kTemperatureUnits;
    case Dimension::kTime:
      return kTimeUnits;
    case Dimension::kAngularSpeed:
      return kAngularSpeedUnits;
    case Dimension::kSpeed:
      return kSpeedUnits;
    case Dimension::kAngularAcceleration:
      return kAngularAccelerationUnits;
    case Dimension::kAcceleration:
      return kAccelerationUnits;
    case Dimension::kText:
    case Dimension::kNone:
    case Dimension::kInteger:
      return {};
  }
  return {};
}

std::string text_in(const Unit& unit, double value_si) {
  const double value = value_si * unit.divide / unit.multiply;
  if (!std::isfinite(value)) return number_text(value);
  for (const int digits : {15, 16}) {
    const std::string text = fmt::format("{:.{}g}", value, digits);
    const auto rounded = parse_number(text);
    if (rounded && unit.to_si(*rounded) == value_si) return number_text(*rounded);
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double near : {std::nextafter(value, -kInfinity), std::nextafter(value, kInfinity)}) {
    if (unit.to_si(value) != value_si && unit.to_si(near) == value_si) return number_text(near);
  }
  return number_text(value);
}

std::vector<std::string> names_of(std::string_view quantity, Dimension dimension) {
  const std::span<const Unit> units = units_of(dimension);
  if (units.empty()) return {std::string(quantity)};
  std::vector<std::string> names;
  for (const Unit& unit : units) {
    names.push_back(std::string(quantity) + "_" + std::string(unit.suffix));
  }
  return names;
}

}  // namespace armsig::tool
