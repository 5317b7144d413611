// SPDX-License-Identifier: MIT
// What a self-test says, line by line, and counts of instructions.
//
//   arms number=N origin="WORDS"
//   check NAME ok|FAILED worst=W limit=L
//   count NAME instructions=N
//   stack bytes=B
//
// Counts are taken with the SysTick timer (ARMv7-M Architecture Reference Manual, B3.3) under
// instruction-accurate emulation: QEMU's -icount shift=5 makes one instruction 32 ns, one tick of
// 25 MHz is 1.25 instructions, the same on every machine.
#pragma once

#include <cstdint>
#include <string_view>

namespace armsig::selftest {

class Report {
 public:
  // What the checks are of.
  void arms(std::size_t number, std::string_view origin);
  // `worst` and `limit` in nanometres or the like: printed with 3 decimals.
  void check(std::string_view name, double worst, double limit);
  void count(std::string_view name, double instructions);
  // The pattern's high-water mark of the stack; the guard below it must be whole.
  void stack();
  [[nodiscard]] bool passed() const { return passed_; }

 private:
  bool passed_ = true;
};

void start_counter();
[[nodiscard]] std::uint32_t counter();
[[nodiscard]] double instructions_between(std::uint32_t begin, std::uint32_t end);

// The compiler must think that `value` is read and written here.
template <typename T>
inline void keep(T& value) {
  asm volatile("" : : "r"(&value) : "memory");
}

// Instructions of one call of `work(k)`, on average over k = 0 ... calls - 1, the loop not counted.
template <typename Work>
[[nodiscard]] double instructions_of(std::uint32_t calls, Work work) {
  const auto timed = [calls](auto&& body) {
    const std::uint32_t begin = counter();
    for (std::uint32_t k = 0; k < calls; ++k) {
      keep(k);
      body(k);
    }
    return instructions_between(begin, counter());
  };
  const double empty = timed([](std::uint32_t) {});
  return (timed(work) - empty) / calls;
}

}  // namespace armsig::selftest
