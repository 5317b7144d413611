// SPDX-License-Identifier: MIT
#include "core/measurement/speed_of_sound.hpp"

#include <cmath>

#include "core/base/check.hpp"

namespace armsig::measurement {

namespace {

double in_dry_air(double celsius) { return 331.3 * std::sqrt(1.0 + celsius / 273.15); }

}  // namespace

Result<double> speed_of_sound(double air_celsius) {
  if (!std::isfinite(air_celsius)) return std::unexpected(Error::kNotFinite);
  if (air_celsius < kLowestAirCelsius || air_celsius > kHighestAirCelsius)
    return std::unexpected(Error::kTemperatureImplausible);
  return in_dry_air(air_celsius);
}

Result<double> speed_from_reference(double length_m, double seconds) {
  ARMSIG_CHECK(std::isfinite(length_m));
  ARMSIG_CHECK(length_m > 0);
  if (!std::isfinite(seconds)) return std::unexpected(Error::kNotFinite);
  const double speed = length_m / seconds;
  if (speed < in_dry_air(kLowestAirCelsius) || speed > in_dry_air(kHighestAirCelsius))
    return std::unexpected(Error::kTemperatureImplausible);
  return speed;
}

}  // namespace armsig::measurement
