// SPDX-License-Identifier: MIT
// An instrument that publishes points in registers: where x, y and z stand, and what they mean.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/pose.hpp"
#include "hal/modbus/channels.hpp"

namespace armsig::modbus {

// All in one unit, by one function, near enough for one request: they are of one moment.
struct PointProfile {
  std::uint8_t unit = 1;
  std::uint8_t function = 4;  // 3: holding registers, 4: input registers
  Format format = Format::kF32;
  bool high_word_first = true;
  double metres_a_step = 0;
  std::uint16_t x = 0;  // their registers, which count from 0
  std::uint16_t y = 2;
  std::uint16_t z = 4;
  // A number of one register that changes with every point. Where it is empty, there is a new point
  std::optional<std::uint16_t> counter{};
  hal::Duration update_period{};  // as often as this
};

// Errors: kProfileInvalid (a unit outside 1 to 247; a function that is neither 3 nor 4; registers
// beyond 65535, in common, or too far apart for one request; a step that is not positive; neither a
// counter nor a period, or both).
[[nodiscard]] Result<ReadRequest> request_of(const PointProfile& profile);

struct RegisterPoint {
  Vector3 p_S = Vector3::Zero();
  std::optional<std::uint32_t> sequence{};
};

// Errors: kSensorMalformed (a coordinate that is no number, or farther than `farthest_m`).
// Precondition: the registers of request_of(profile).
[[nodiscard]] Result<RegisterPoint> point_in(const PointProfile& profile,
                                             const ReadRequest& request,
                                             std::span<const std::uint16_t> registers,
                                             double farthest_m);

}  // namespace armsig::modbus
