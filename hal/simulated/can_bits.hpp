// SPDX-License-Identifier: MIT
// How long a CAN frame occupies the wire, bit by bit.
#pragma once

#include <cstdint>

#include "hal/can_bus.hpp"

namespace armsig::simulated {

// Bits of `frame` on the wire, with the stuff bits that its content really needs, its CRC included,
// and with the interframe space (ISO 11898-1, 10.4 and 10.5).
[[nodiscard]] unsigned wire_bits(const hal::CanFrame& frame);

// The lower of two wins the bus: by the first 11 bits of the identifier, then the base format.
[[nodiscard]] std::uint32_t precedence(const hal::CanFrame& frame);

}  // namespace armsig::simulated
