// SPDX-License-Identifier: MIT
#include "firmware/cabinet_r5f/platform.hpp"
#include "hal/r5f/system_watchdog.hpp"

namespace armsig::cabinet {

hal::Watchdog& watchdog() {
  constexpr std::uintptr_t kLowPowerDomain = 0xFF15'0000;
  static r5f::SystemWatchdog watchdog(kLowPowerDomain);
  return watchdog;
}

const volatile std::uint32_t* forced_can_state() { return nullptr; }

}  // namespace armsig::cabinet
