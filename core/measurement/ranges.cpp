// SPDX-License-Identifier: MIT
#include "core/measurement/ranges.hpp"

#include <cmath>

namespace armsig::measurement {

Ranges ranges_from_times(const FlightTimes& flights, double speed, SoundPath path) {
  ARMSIG_CHECK(std::isfinite(speed));
  ARMSIG_CHECK(speed > 0);
  const double trips = path == SoundPath::kEcho ? 2 : 1;
  Ranges ranges;
  for (const FlightTime& flight : flights)
    ranges.push_back(
        {.metres = speed * flight.seconds / trips, .valid = flight.valid && flight.seconds > 0});
  return ranges;
}

}  // namespace armsig::measurement
