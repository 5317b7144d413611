// SPDX-License-Identifier: MIT
#include "core/measurement/speed_of_sound.hpp"

#include <cmath>

#include "core/base/check.hpp"
#include "core/base/dry_air.hpp"

namespace armsig::measurement {

Result<double> speed_of_sound(double air_celsius) {
  if (!std::isfinite(air_celsius)) return std::unexpected(Error::kNotFinite);
  if (air_celsius < kLowestAirCelsius || air_celsius > kHighestAirCelsius)
    return std::unexpected(Error::kTemperatureImplausible);
  return speed_in_dry_air(air_celsius);
}

Result<double> speed_from_reference(double length_m, double seconds) {
  ARMSIG_CHECK(std::isfinite(length_m));
  ARMSIG_CHECK(length_m > 0);
  if (!std::isfinite(seconds)) return std::unexpected(Error::kNotFinite);
  const double speed = length_m / seconds;
  if (speed < speed_in_dry_air(kLowestAirCelsius) || speed > speed_in_dry_air(kHighestAirCelsius))
    return std::unexpected(Error::kTemperatureImplausible);
  return speed;
}

}  // namespace armsig::measurement
