// SPDX-License-Identifier: MIT
// Start-up of a Cortex-R5F (ARMv7-A/R Architecture Reference Manual, DDI 0406; Cortex-R5 Technical
// Reference Manual, DDI 0460): vectors, FPU, memory protection, memory, stack pattern, main.
#include <cstdint>

#include "toolchain/boards/memory_image.hpp"
#include "toolchain/boards/r5f/protection.hpp"
#include "toolchain/boards/stack.hpp"

// On an exception the core stops: the drives lose their SYNC and stop by themselves, and the
// watchdog resets the core. The vectors and the first instructions are ARM, as the core takes them
// after a reset: stack, FPU (coprocessors 10 and 11, then its enable bit), then C++.
asm(R"(
  .section .vectors, "ax", %progbits
  .arm
  ldr pc, =armsig_reset
  b armsig_stop
  b armsig_stop
  b armsig_stop
  b armsig_stop
  nop
  b armsig_stop
  b armsig_stop
  .global armsig_stop
  .type armsig_stop, %function
armsig_stop:
  wfe
  b armsig_stop
  .ltorg

  .global armsig_reset
  .type armsig_reset, %function
armsig_reset:
  cpsid aif
  ldr sp, =armsig_stack_top
  mrc p15, 0, r0, c1, c0, 2
  orr r0, r0, #0x00F00000
  mcr p15, 0, r0, c1, c0, 2
  isb
  mov r0, #0x40000000
  vmsr fpexc, r0
  ldr r0, =armsig_start
  bx r0
  .ltorg
  .size armsig_reset, . - armsig_reset
  .text
  .thumb
)");

namespace armsig::board {
namespace {

// One region of the memory protection unit; what no region covers may not be touched.
void set_region(std::uint32_t number, const Region& region) {
  asm volatile("mcr p15, 0, %0, c6, c2, 0" : : "r"(number));
  asm volatile("mcr p15, 0, %0, c6, c1, 0" : : "r"(region.base));
  asm volatile("mcr p15, 0, %0, c6, c1, 4" : : "r"(region.access));
  asm volatile("mcr p15, 0, %0, c6, c1, 2"
               :
               : "r"(std::uint32_t{region.without} << 8 | (region.size_log2 - 1U) << 1 | 1U));
}

void protect_memory() {
  std::uint32_t number = 0;
  for (const Region& region : regions()) set_region(number++, region);
  // The guard of the stack: the highest region wins.
  set_region(number, {reinterpret_cast<std::uintptr_t>(armsig_stack_bottom), kStackGuardLog2,
                      Access::kReadOnly, 0});
  std::uint32_t control = 0;
  asm volatile("mcr p15, 0, %0, c7, c5, 0" : : "r"(0));   // invalidates the instruction cache
  asm volatile("mcr p15, 0, %0, c15, c5, 0" : : "r"(0));  // and the data cache
  asm volatile("mrc p15, 0, %0, c1, c0, 0" : "=r"(control));
  constexpr std::uint32_t kProtection = 1;
  constexpr std::uint32_t kDataCache = 1U << 2;
  constexpr std::uint32_t kInstructionCache = 1U << 12;
  control |= kProtection | kDataCache | kInstructionCache;
  asm volatile("dsb\n mcr p15, 0, %0, c1, c0, 0\n isb" : : "r"(control) : "memory");
}

}  // namespace
}  // namespace armsig::board

extern "C" {

[[noreturn]] void armsig_main();

[[noreturn, gnu::used]] void armsig_start() {
  armsig::board::paint_stack();
  armsig::board::initialise_memory();
  armsig::board::protect_memory();
  // From here on an error that the bus tells late stops the core as any other does.
  asm volatile("cpsie a" : : : "memory");
  armsig_main();
}

// A pure virtual method called: our mistake.
[[noreturn]] void __cxa_pure_virtual() { __builtin_trap(); }

// The functions of <cmath> tell errors that nobody reads. The library's own place for them lies in
// a kilobyte of state that no image needs.
// NOLINTNEXTLINE(bugprone-reserved-identifier)
int* __errno() {
  static int error;
  return &error;
}

// The library's own would raise a signal, and with it bring the heap.
[[noreturn]] void abort() { __builtin_trap(); }
}
