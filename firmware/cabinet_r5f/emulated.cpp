// SPDX-License-Identifier: MIT
// What QEMU's board lacks, played by the emulated arm on the other core: a watchdog, and a CAN bus
// that has errors.
#include "firmware/cabinet_r5f/emulated_world.hpp"
#include "firmware/cabinet_r5f/platform.hpp"

namespace armsig::cabinet {
namespace {

class OtherCoreWatchdog final : public hal::Watchdog {
 public:
  OtherCoreWatchdog() : caused_reset_(emulated_world().bitten == kMagic) {
    emulated_world().bitten = 0;
  }

 private:
  void do_kick() override {
    while (emulated_world().stall == kMagic) asm volatile("yield");
    emulated_world().kicks = emulated_world().kicks + 1;
  }
  [[nodiscard]] bool do_caused_reset() const override { return caused_reset_; }

  bool caused_reset_;
};

}  // namespace

hal::Watchdog& watchdog() {
  static OtherCoreWatchdog watchdog;
  return watchdog;
}

const volatile std::uint32_t* forced_can_state() { return &emulated_world().can_state; }

}  // namespace armsig::cabinet
