// SPDX-License-Identifier: MIT
// Helpers for readings of a range sensor.
#pragma once

#include <chrono>
#include <cstdint>
#include <initializer_list>

#include "hal/range_sensor.hpp"

namespace armsig::test {

inline hal::Instant at_ms(int milliseconds) {
  return hal::Instant(std::chrono::milliseconds(milliseconds));
}

inline hal::RangeReading reading(std::uint32_t sequence, std::initializer_list<double> flights_s,
                                 double air_celsius = 23.0) {
  hal::RangeReading result;
  result.sequence = sequence;
  result.air_celsius = air_celsius;
  for (const double flight_s : flights_s) result.receivers.push_back({flight_s > 0, flight_s});
  return result;
}

}  // namespace armsig::test
