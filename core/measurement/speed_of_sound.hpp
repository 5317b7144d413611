// SPDX-License-Identifier: MIT
// Speed of sound in air: from its temperature, or from a path of known length.
//
// The reference path is to be preferred: it sees humidity (up to +0.4 % at 30 degrees Celsius,
// which the temperature formula leaves out) and the temperature of the air that the sound goes
// through.
#pragma once

#include "core/base/error.hpp"

namespace armsig::measurement {

// Air outside of these limits is a broken thermometer, not a workshop.
inline constexpr double kLowestAirCelsius = -20;
inline constexpr double kHighestAirCelsius = 60;

// speed_in_dry_air(), (M1) of docs/model.md. A kelvin is worth 1.7 mm per metre of range. Errors:
// kNotFinite; kTemperatureImplausible outside of the limits above.
[[nodiscard]] Result<double> speed_of_sound(double air_celsius);

// Speed over a path of `length_m` > 0 metres, measured in the same air as the ranges. `length_m` is
// what the sound travels: twice the distance for an echo.
// Errors: kNotFinite; kTemperatureImplausible if no plausible air carries sound at this speed.
[[nodiscard]] Result<double> speed_from_reference(double length_m, double seconds);

}  // namespace armsig::measurement
