// SPDX-License-Identifier: MIT
// Range sensors that publish one number a channel, as those that are sold do: in which unit and
// register it stands, in which format, and what it means.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "core/base/error.hpp"
#include "hal/modbus/rtu.hpp"
#include "hal/range_sensor.hpp"

namespace armsig::modbus {

enum class Format : std::uint8_t { kU16, kI16, kU32, kI32, kF32 };

// How many registers a number in this format takes.
[[nodiscard]] constexpr std::uint16_t registers_in(Format format) {
  return format == Format::kU16 || format == Format::kI16 ? 1 : 2;
}

// Where a number stands. Register numbers count from 0, as on the wire.
struct Field {
  std::uint8_t unit = 1;
  std::uint8_t function = 4;  // 3: holding registers, 4: input registers
  std::uint16_t first = 0;
  Format format = Format::kU16;
  bool high_word_first = true;
  double step = 1;  // what 1 in the register is: seconds, metres or degrees Celsius
};

inline constexpr std::size_t kRegisters = 0x10000;  // of a unit, by one function

// The register behind the last one of a field.
[[nodiscard]] constexpr std::size_t end_of(const Field& field) {
  return std::size_t{field.first} + registers_in(field.format);
}

// What one receiver heard.
struct Channel {
  static constexpr std::size_t kMaxInvalid = 4;

  Field field{};
  double offset = 0;  // seconds or metres that are added to the way of one direction
  // As they stand in the register: values outside of these are no range,
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  FixedVector<double, kMaxInvalid> invalid{};  // and neither are these
};

struct ChannelProfile {
  FixedVector<Channel, kMaxReceivers> channels{};  // in the order of the receivers
  bool distance = false;                           // channels are in metres, not in seconds
  bool echo = false;                               // they are there and back
  // Of distances: the speed of sound, m/s, by which the sensor computes them, whatever the air is.
  // 0: the sensor corrects for the air by itself.
  double sound_m_s = 0;
  std::optional<Field> air{};     // its temperature
  double fixed_air_celsius = 20;  // where `air` is empty
  // A number that changes with every reading. Where it is empty, every round is a new reading,
  std::optional<Field> counter{};
  hal::Duration update_period{};  // and the sensor measures this often
  std::uint16_t largest_gap = 8;  // registers that nobody asked for between two in one request
};

// A channel each, the air and the counter.
inline constexpr std::size_t kMaxFields = kMaxReceivers + 2;
using Requests = FixedVector<ReadRequest, kMaxFields>;

// As few requests as read all fields: by unit, function and register, what is near in one.
// Errors: kProfileInvalid (no channel; a unit outside 1 to 247; a function that is neither 3 nor 4;
// registers beyond 65535, or two fields in one register; a step that is not positive; a counter in
// kF32; an offset, a bound or a speed that cannot be).
[[nodiscard]] Result<Requests> requests_of(const ChannelProfile& profile);

// Whether two fields have a register in common.
[[nodiscard]] bool overlap(const Field& a, const Field& b);

// Whether `request` brings `field`.
[[nodiscard]] bool covers(const ReadRequest& request, const Field& field);

// The number in `field`, as it stands there: without its step. Any double of a kF32, NaN included.
// Preconditions: covers(request, field), and as many registers as the request asks for.
[[nodiscard]] double number_in(const Field& field, const ReadRequest& request,
                               std::span<const std::uint16_t> registers);

// The speed, m/s, by which distances are times of flight. Of a sensor that corrects for the air it
// is the one at `air_celsius`: whoever makes ranges of the times by the same temperature has the
// sensor's distances again.
[[nodiscard]] double speed_of(const ChannelProfile& profile, double air_celsius);

// What a receiver heard, by the number in the channel's field: invalid where that is not finite,
// out of its bounds, among its invalid values, or no way above zero.
[[nodiscard]] hal::ReceiverReading reading_of(const ChannelProfile& profile, const Channel& channel,
                                              double number, double speed_m_s);

}  // namespace armsig::modbus
