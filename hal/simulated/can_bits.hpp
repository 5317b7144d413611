// SPDX-License-Identifier: MIT
// How long a CAN frame occupies the wire, bit by bit.
#pragma once

#include "hal/can_bus.hpp"

namespace armsig::simulated {

// Bits of `frame` (11-bit identifiers only) on the wire, with the stuff bits that its content
// really needs, its CRC included, and with the interframe space (ISO 11898-1, 10.4 and 10.5).
// Precondition: not extended.
[[nodiscard]] unsigned wire_bits(const hal::CanFrame& frame);

}  // namespace armsig::simulated
