// SPDX-License-Identifier: MIT
#include "hal/r5f/system_watchdog.hpp"

namespace armsig::r5f {
namespace {

constexpr std::uint32_t kMode = 0x00;
constexpr std::uint32_t kControl = 0x04;
constexpr std::uint32_t kRestart = 0x08;
constexpr std::uint32_t kStatus = 0x0C;

// A write without its key is ignored.
constexpr std::uint32_t kModeKey = 0xABCU << 12;
constexpr std::uint32_t kEnable = 1;
constexpr std::uint32_t kResetOutput = 1U << 1;
constexpr std::uint32_t kControlKey = 0x248U << 14;
// The reload value's upper 12 bits; the lower 12 are ones.
constexpr std::uint32_t kReload = 0U << 2;
constexpr std::uint32_t kDivideBy4096 = 3;
constexpr std::uint32_t kRestartKey = 0x1999;
constexpr std::uint32_t kReachedZero = 1;

}  // namespace

SystemWatchdog::SystemWatchdog(std::uintptr_t base)
    : registers_(base), caused_reset_((registers_.read(kStatus) & kReachedZero) != 0) {
  registers_.write(kMode, kModeKey);  // stopped while it is set up
  registers_.write(kControl, kControlKey | kReload | kDivideBy4096);
  registers_.write(kRestart, kRestartKey);
  registers_.write(kMode, kModeKey | kResetOutput | kEnable);
}

void SystemWatchdog::do_kick() { registers_.write(kRestart, kRestartKey); }

}  // namespace armsig::r5f
