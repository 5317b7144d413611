// SPDX-License-Identifier: MIT
// Emergency messages of CiA 301, 7.2.7, with the error codes of CiA 301 and CiA 402-2 in words.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hal/can_bus.hpp"

namespace armsig::canopen {

struct Emergency {
  std::uint16_t code = 0;             // 0: every error is gone
  std::uint8_t error_register = 0;    // object 1001h
  std::array<std::uint8_t, 5> own{};  // manufacturer specific
};

// Empty if `frame` has not the eight bytes that the standard demands.
[[nodiscard]] std::optional<Emergency> decode_emergency(const hal::CanFrame& frame);

// Whether it tells something that is no error: no bit of the error register is set (bit 0 is set by
// any error, CiA 301, 7.5.2.2), or the device has come back from bus-off (8140h).
[[nodiscard]] bool is_information(const Emergency& emergency);

// A short English phrase for an error code: of the code itself if it is known, else of its class.
[[nodiscard]] std::string_view describe_emergency(std::uint16_t code);

}  // namespace armsig::canopen
