// SPDX-License-Identifier: MIT
// Ranges from times of flight.
#pragma once

#include <cstdint>

#include "core/base/flight_time.hpp"

namespace armsig::measurement {

// Distance from one receiver to the target.
struct Range {
  double metres = 0;
  bool valid = false;
  // 1 sigma of this range in units of ReceiverArray::range_sigma_m: 1 for a single ping, less for
  // the median of several.
  double sigma_factor = 1;
};

// One per receiver of the array, in its order.
using Ranges = FixedVector<Range, kMaxReceivers>;

enum class SoundPath : std::uint8_t {
  kOneWay,  // the target emits, each receiver hears it
  kEcho,    // each receiver emits and hears its own echo: the sound travels the range twice
};

// Range = speed x time, halved for an echo. A time that isn't positive is no measurement, whatever
// the sensor says. `speed` in m/s, positive, as speed_of_sound.hpp gives it.
[[nodiscard]] Ranges ranges_from_times(const FlightTimes& flights, double speed, SoundPath path);

}  // namespace armsig::measurement
