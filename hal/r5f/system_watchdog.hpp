// SPDX-License-Identifier: MIT
// The system watchdog timer of the low-power domain (UG1085, chapter "System Watchdog Timers";
// registers UG1087, module SWDT).
#pragma once

#include "hal/r5f/registers.hpp"
#include "hal/watchdog.hpp"

namespace armsig::r5f {

class SystemWatchdog final : public hal::Watchdog {
 public:
  // Starts the timer of the block at `base`: 100 MHz / 4096 counts 4,096 steps in 168 ms. What is
  // to be reset is the platform management unit's business, as the boot loader has told it.
  explicit SystemWatchdog(std::uintptr_t base);

 private:
  void do_kick() override;
  [[nodiscard]] bool do_caused_reset() const override { return caused_reset_; }

  Registers registers_;
  bool caused_reset_;
};

}  // namespace armsig::r5f
