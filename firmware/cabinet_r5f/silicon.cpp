// SPDX-License-Identifier: MIT
#include "firmware/cabinet_r5f/platform.hpp"
#include "firmware/cabinet_r5f/regions.hpp"
#include "hal/r5f/registers.hpp"
#include "hal/r5f/system_watchdog.hpp"

namespace armsig::cabinet {

hal::Watchdog& watchdog() {
  constexpr std::uintptr_t kLowPowerDomain = 0xFF15'0000;
  static r5f::SystemWatchdog watchdog(kLowPowerDomain);
  return watchdog;
}

const volatile std::uint32_t* forced_can_state() { return nullptr; }

// Reset reason of the low-power domain (UG1087, CRL_APB): the external and the internal power-on
// reset. They stay set over later resets until they are cleared, by writing ones.
bool lost_power() {
  constexpr std::uintptr_t kClockAndReset = 0xFF5E'0000;
  constexpr std::uint32_t kResetReason = 0x220;
  constexpr std::uint32_t kPowerOn = 0b11;
  const r5f::Registers registers(kClockAndReset);
  const bool lost = (registers.read(kResetReason) & kPowerOn) != 0;
  registers.write(kResetReason, kPowerOn);
  return lost;
}

}  // namespace armsig::cabinet

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" constexpr armsig::board::RegionTable<armsig::cabinet::kRegions.size()>
    armsig_mpu_regions = armsig::cabinet::kRegions;

std::span<const armsig::board::Region> armsig::board::regions() { return armsig_mpu_regions; }
