// SPDX-License-Identifier: MIT
// In what silicon and emulator differ.
#pragma once

#include <cstdint>

#include "hal/watchdog.hpp"

namespace armsig::cabinet {

// Starts it; to be called once.
[[nodiscard]] hal::Watchdog& watchdog();

// Whether memory has lost its contents since the program ran last, error correction included: what
// was not written since may not be read. To be called once.
[[nodiscard]] bool lost_power();

// Null on silicon, which has error states of its own (hal/r5f/can_controller.hpp).
[[nodiscard]] const volatile std::uint32_t* forced_can_state();

}  // namespace armsig::cabinet
