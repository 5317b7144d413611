// SPDX-License-Identifier: MIT
#include "hal/r5f/cycle_clock.hpp"

namespace armsig::r5f {
namespace {

constexpr std::uint64_t kDivider = 64;
constexpr hal::Duration kTick{kDivider * 1'000'000'000ULL / CycleClock::kCoreHz};

// Between two looks: a microsecond in which an emulator need not look after the counter.
constexpr unsigned kSpins = 300;

std::uint32_t cycles() {
  std::uint32_t count = 0;
  asm volatile("mrc p15, 0, %0, c9, c13, 0" : "=r"(count));
  return count;
}

}  // namespace

CycleClock::CycleClock() {
  // PMCR: enable, reset of the cycle counter, divide by 64; then the counter's own enable bit.
  constexpr std::uint32_t kEnable = 1;
  constexpr std::uint32_t kReset = 1U << 2;
  constexpr std::uint32_t kBy64 = 1U << 3;
  constexpr std::uint32_t kCycleCounter = 1U << 31;
  asm volatile("mcr p15, 0, %0, c9, c12, 0" : : "r"(kEnable | kReset | kBy64));
  asm volatile("mcr p15, 0, %0, c9, c12, 1" : : "r"(kCycleCounter));
  last_ = cycles();
}

hal::Instant CycleClock::do_now() {
  const std::uint32_t now = cycles();
  counted_ += now - last_;  // without borrow, also over a wrap
  last_ = now;
  return hal::Instant(kTick * static_cast<hal::Duration::rep>(counted_));
}

hal::Duration CycleClock::do_wait_until(hal::Instant tick) {
  for (;;) {
    const hal::Instant now = do_now();
    if (now >= tick) return now - tick;
    for (unsigned i = 0; i < kSpins; ++i) asm volatile("nop");
    asm volatile("yield");  // lets an emulator run another core meanwhile
  }
}

}  // namespace armsig::r5f
