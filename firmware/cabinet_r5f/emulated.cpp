// SPDX-License-Identifier: MIT
// What QEMU's board lacks, played by the emulated arm on the other core: a watchdog, and a CAN bus
// that has errors.
#include "firmware/cabinet_r5f/emulated_world.hpp"
#include "firmware/cabinet_r5f/platform.hpp"
#include "firmware/cabinet_r5f/regions.hpp"

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

// The emulator's memory holds what it is loaded with.
bool lost_power() { return false; }

const volatile std::uint32_t* forced_can_state() { return &emulated_world().can_state; }

constexpr std::size_t kRegionCount = kRegions.size() + 1;

constexpr board::RegionTable<kRegionCount> with_emulated_world() {
  board::RegionTable<kRegionCount> table{};
  for (std::size_t i = 0; i < kRegions.size(); ++i) table[i] = kRegions[i];
  table[kRegions.size()] = {kEmulatedWorldAt, kEmulatedWorldLog2, board::kShared, 0};
  return table;
}

}  // namespace armsig::cabinet

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" constexpr armsig::board::RegionTable<armsig::cabinet::kRegionCount> armsig_mpu_regions =
    armsig::cabinet::with_emulated_world();

std::span<const armsig::board::Region> armsig::board::regions() { return armsig_mpu_regions; }
