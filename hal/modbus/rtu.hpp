// SPDX-License-Identifier: MIT
// Modbus RTU frames (MODBUS over Serial Line V1.02; MODBUS Application Protocol V1.1b3): reading
// registers, as a master.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>
#include <string_view>

#include "core/base/error.hpp"
#include "core/base/fixed_vector.hpp"
#include "hal/clock.hpp"
#include "hal/modbus/profile.hpp"

namespace armsig::modbus {

inline constexpr std::size_t kReadRequestBytes = 8;
inline constexpr std::size_t kMaxFrameBytes = 256;

using Registers = FixedVector<std::uint16_t, kMaxRegisters>;

struct ReadRequest {
  std::uint8_t unit = 1;
  std::uint8_t function = 4;
  RegisterRange registers;
};

struct Failure {
  Error error = Error::kSensorMalformed;
  std::uint8_t exception = 0;  // of kSensorException
};

// CRC-16 of Modbus (polynomial 8005h reflected, start FFFFh), sent low byte first.
[[nodiscard]] std::uint16_t crc16(std::span<const std::uint8_t> bytes);

[[nodiscard]] std::array<std::uint8_t, kReadRequestBytes> encode(const ReadRequest& request);

// How long a whole answer is that begins with `bytes`; 0 while that cannot be told yet. An answer
// to something else has the length it says itself, so that it can be told from line noise.
[[nodiscard]] std::size_t answer_bytes(std::span<const std::uint8_t> bytes);

// The registers of a complete answer. Errors: kSensorBadCrc, kSensorWrongUnit (also: another
// function), kSensorException, kSensorMalformed (another number of registers than asked for, or too
// short for any answer).
[[nodiscard]] std::expected<Registers, Failure> decode(const ReadRequest& request,
                                                       std::span<const std::uint8_t> answer);

// The same of what is between the frame's own parts on any line: unit, function, and what follows.
// Errors: as above, but for kSensorBadCrc.
[[nodiscard]] std::expected<Registers, Failure> decode_body(const ReadRequest& request,
                                                            std::span<const std::uint8_t> body);

// A short English phrase for a Modbus exception code.
[[nodiscard]] std::string_view describe_exception(std::uint8_t code);

// The pause of 3.5 characters that ends a frame; 1.75 ms above 19200 baud (MODBUS over Serial Line,
// 2.5.1.1). A character is 11 bits.
[[nodiscard]] constexpr hal::Duration frame_pause(std::uint32_t baud) {
  if (baud > 19200) return std::chrono::microseconds(1750);
  return std::chrono::nanoseconds(38'500'000'000 / baud);
}

}  // namespace armsig::modbus
