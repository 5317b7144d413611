// SPDX-License-Identifier: MIT
// An instrument that publishes coordinates or lengths in registers: where they stand, and what they
// mean.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/length_instrument.hpp"
#include "hal/modbus/channels.hpp"

namespace armsig::modbus {

// Three coordinates, or as many lengths.
inline constexpr std::size_t kMaxNumbers = std::max<std::size_t>(3, hal::kMaxLengths);

// All in one unit, by one function, near enough for one request: they are of one moment.
struct NumberProfile {
  std::uint8_t unit = 1;
  std::uint8_t function = 4;  // 3: holding registers, 4: input registers
  Format format = Format::kF32;
  bool high_word_first = true;
  double metres_a_step = 0;
  FixedVector<std::uint16_t, kMaxNumbers> registers{};  // their first ones, which count from 0
  // A number of one register that changes with every reading. Where it is empty, there is a new one
  std::optional<std::uint16_t> counter{};
  hal::Duration update_period{};  // as often as this
};

// Errors: kProfileInvalid (no register; a unit outside 1 to 247; a function that is neither 3 nor
// 4; registers beyond 65535, in common, or too far apart for one request; a step that is not
// positive; neither a counter nor a period, or both).
[[nodiscard]] Result<ReadRequest> request_of(const NumberProfile& profile);

struct RegisterNumbers {
  FixedVector<double, kMaxNumbers> metres;  // as they stand there: NaN and infinities too
  std::optional<std::uint32_t> sequence{};
};

// Precondition: the registers of request_of(profile).
[[nodiscard]] RegisterNumbers numbers_in(const NumberProfile& profile, const ReadRequest& request,
                                         std::span<const std::uint16_t> registers);

}  // namespace armsig::modbus
