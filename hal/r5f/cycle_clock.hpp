// SPDX-License-Identifier: MIT
// Monotonic time from the core's own cycle counter (ARMv7-A/R Architecture Reference Manual, DDI
// 0406, chapter "The Performance Monitors Extension"), polled.
//
// It counts every 64th cycle in 32 bits and wraps after nine minutes: time must be asked for at
// least that often, and the core may not be stopped to wait (WFI stops the counter, too). The
// triple timers of the chip would serve as well on silicon; the emulator's stall it when it counts
// instructions.
#pragma once

#include <cstdint>

#include "hal/clock.hpp"

namespace armsig::r5f {

class CycleClock final : public hal::Clock {
 public:
  static constexpr std::uint64_t kCoreHz = 500'000'000;  // as the boot loader leaves it

  // Starts the counter; the epoch is now.
  CycleClock();

 private:
  hal::Instant do_now() override;
  // Spins; a tick is never further away than a period.
  hal::Duration do_wait_until(hal::Instant tick) override;

  std::uint32_t last_ = 0;
  std::uint64_t counted_ = 0;
};

}  // namespace armsig::r5f
