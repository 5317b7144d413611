// SPDX-License-Identifier: MIT
// Which registers of a Modbus range sensor mean what.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/error.hpp"
#include "hal/range_sensor.hpp"

namespace armsig::modbus {

// The most registers that one request may ask for (MODBUS Application Protocol V1.1b3, 6.3).
inline constexpr std::size_t kMaxRegisters = 125;

// Units are numbered from 1 to here (MODBUS over Serial Line V1.02, 2.2).
inline constexpr std::uint8_t kLargestUnit = 247;

// Register numbers count from 0, as on the wire. The defaults are armsig's own sensor map.
struct Profile {
  std::uint8_t unit = 1;
  std::uint8_t function = 4;          // 3: holding registers, 4: input registers
  std::uint16_t status = 0;           // bit j: receiver j valid
  std::uint16_t sequence = 1;         // changes with every reading
  std::uint16_t air_temperature = 2;  // signed, in steps of `celsius_a_step`
  double celsius_a_step = 0.1;
  std::uint16_t receiver_count = 3;  // how many receivers the sensor has
  std::uint16_t first_flight = 4;    // flight time of receiver 0, two registers
  std::uint16_t flight_stride = 2;   // registers from one receiver's time to the next one's
  double seconds_a_step = 1e-9;
  bool high_word_first = true;
  bool echo = false;          // flight times are there and back
  std::size_t receivers = 4;  // how many are read
};

// The registers of `profile`, read in one request.
struct RegisterRange {
  std::uint16_t first = 0;
  std::uint16_t count = 0;
};

// Errors: kProfileInvalid (unit outside 1 to 247, function neither 3 nor 4, no receiver or more
// than kMaxReceivers, times that overlap, a step that is not positive, registers too far apart for
// one request).
[[nodiscard]] Result<RegisterRange> registers_of(const Profile& profile);

// The reading in `registers`, which are those of registers_of(profile); its time stamp is left to
// the caller. Errors: kSensorMalformed (wrong number of registers; fewer receivers than the profile
// reads).
[[nodiscard]] Result<hal::RangeReading> decode(const Profile& profile,
                                               std::span<const std::uint16_t> registers);

}  // namespace armsig::modbus
