// SPDX-License-Identifier: MIT
// What a time-of-flight range sensor measures, whatever bus it speaks.
#pragma once

#include <cstddef>

#include "core/base/fixed_vector.hpp"

namespace armsig {

inline constexpr std::size_t kMaxReceivers = 16;

// Time from the emission of a ping to its arrival at one receiver.
struct FlightTime {
  double seconds = 0;
  bool valid = false;
};

// One per receiver, in the order of the sensor description.
using FlightTimes = FixedVector<FlightTime, kMaxReceivers>;

}  // namespace armsig
