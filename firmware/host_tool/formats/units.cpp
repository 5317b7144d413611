// SPDX-License-Identifier: MIT
#include "firmware/host_tool/formats/units.hpp"

#include <array>

namespace armsig::tool {
namespace {

constexpr std::array<Unit, 2> kAngleUnits{{{"deg", kPi / 180.0, 1}, {"rad", 1, 1}}};
constexpr std::array<Unit, 2> kLengthUnits{{{"mm", 1, 1000}, {"m", 1, 1}}};
constexpr std::array<Unit, 1> kTemperatureUnits{{{"c", 1, 1}}};

}  // namespace

std::span<const Unit> units_of(Dimension dimension) {
  switch (dimension) {
    case Dimension::kAngle:
      return kAngleUnits;
    case Dimension::kLength:
      return kLengthUnits;
    case Dimension::kTemperature:
      return kTemperatureUnits;
    case Dimension::kNone:
    case Dimension::kInteger:
      return {};
  }
  return {};
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
