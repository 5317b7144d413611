// SPDX-License-Identifier: MIT
// Start-up of a Cortex-M4 or M7 (ARMv7-M Architecture Reference Manual, DDI 0403): vectors, FPU,
// memory, stack pattern, main.
#include <array>
#include <cstdint>

#include "toolchain/boards/memory_image.hpp"
#include "toolchain/boards/semihosting.hpp"
#include "toolchain/boards/stack.hpp"

extern "C" {

int armsig_main();

[[noreturn]] void armsig_start() {
  // Coprocessor Access Control Register: full access to the FPU (CP10 and CP11), before any
  // floating-point instruction.
  auto* const cpacr = reinterpret_cast<volatile std::uint32_t*>(0xE000'ED88);
  *cpacr = *cpacr | (0xFU << 20);
  asm volatile("dsb\n isb" ::: "memory");
  armsig::board::paint_stack();
  armsig::board::initialise_memory();
  armsig::board::leave(static_cast<std::uint32_t>(armsig_main()));
}

[[noreturn]] void armsig_fault() {
  armsig::board::say("fault");
  armsig::board::leave(3);
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
}

namespace {

using Handler = void (*)();

struct Vectors {
  std::uint32_t* stack;
  std::array<Handler, 15> exceptions;
};

// Reset, NMI and the faults; interrupts are not used.
[[gnu::section(".vectors"), gnu::used]] const Vectors kVectors{
    armsig_stack_top,
    {armsig_start, armsig_fault, armsig_fault, armsig_fault, armsig_fault, armsig_fault,
     armsig_fault, armsig_fault, armsig_fault, armsig_fault, armsig_fault, armsig_fault,
     armsig_fault, armsig_fault, armsig_fault}};

}  // namespace
