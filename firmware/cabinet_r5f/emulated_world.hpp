// SPDX-License-Identifier: MIT
// What the two cores share under emulation, beside the CAN bus: what the emulator lacks. It lies in
// memory that no core initialises.
#pragma once

#include <cstdint>

namespace armsig::cabinet {

inline constexpr std::uintptr_t kEmulatedWorldAt = 0x1030'0000;
inline constexpr std::uint32_t kEmulatedWorldLog2 = 16;
inline constexpr std::uint32_t kMagic = 0x4152'4D57;

struct EmulatedWorld {
  volatile std::uint32_t magic;      // kMagic, when the other core has begun
  volatile std::uint32_t can_state;  // error state that CAN0 sees instead of its own; 0: its own
  volatile std::uint32_t kicks;      // of the watchdog, counted by the controller
  volatile std::uint32_t bitten;     // kMagic: the watchdog asked for the last reset
  volatile std::uint32_t stall;      // kMagic: the controller's core is to hang at its next kick
};

[[nodiscard]] inline EmulatedWorld& emulated_world() {
  return *reinterpret_cast<EmulatedWorld*>(kEmulatedWorldAt);
}

}  // namespace armsig::cabinet
