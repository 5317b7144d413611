// SPDX-License-Identifier: MIT
// How much of a CAN bus periodic frames take, at worst.
#pragma once

#include <cstdint>
#include <span>

#include "hal/clock.hpp"

namespace armsig::canopen {

// The part of the bus that periodic frames may take; the rest is for set-up, emergencies and
// repeated frames.
inline constexpr double kLargestBusLoad = 0.80;

// Bits on the wire of an 11-bit data frame with `data_bytes` bytes, with the interframe space and
// the most stuff bits possible: 47 + 8 s bits, of which 34 + 8 s may be stuffed, and the first
// stuff bit follows five equal bits, each further one four (Davis et al., "Controller Area Network
// (CAN) schedulability analysis", Real-Time Systems 35, 2007, equation 1).
[[nodiscard]] constexpr unsigned worst_case_bits(unsigned data_bytes) {
  return 47 + 8 * data_bytes + (34 + 8 * data_bytes - 1) / 4;
}

struct PeriodicFrame {
  std::uint8_t data_bytes = 0;
  hal::Duration period{};  // above zero
};

// The part of the bus that `frames` take together, 1 being all of it.
[[nodiscard]] double bus_load(std::span<const PeriodicFrame> frames, std::uint32_t bits_per_second);

}  // namespace armsig::canopen
