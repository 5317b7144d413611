// SPDX-License-Identifier: MIT
// Words to the emulator or debugger that runs the image ("Semihosting for AArch32 and AArch64",
// Arm), for the self-tests: without one of the two a call traps.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace armsig::board {

inline std::uint32_t semihosting(std::uint32_t operation, const void* argument) {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = argument;
#if __ARM_ARCH_PROFILE == 'M'
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
#elif defined(__thumb__)
  asm volatile("svc 0xab" : "+r"(r0) : "r"(r1) : "memory", "lr");
#else
  asm volatile("svc 0x123456" : "+r"(r0) : "r"(r1) : "memory", "lr");
#endif
  return r0;
}

// One line to the emulator's standard output.
inline void say(std::string_view line) {
  constexpr std::uint32_t kWriteCharacter = 0x03;
  for (const char& c : line) semihosting(kWriteCharacter, &c);
  constexpr char kEnd = '\n';
  semihosting(kWriteCharacter, &kEnd);
}

// Ends the emulation with an exit status.
[[noreturn]] inline void leave(std::uint32_t status) {
  constexpr std::uint32_t kExitExtended = 0x20;
  constexpr std::uint32_t kApplicationExit = 0x20026;
  const std::array<std::uint32_t, 2> argument{kApplicationExit, status};
  for (;;) semihosting(kExitExtended, argument.data());
}

}  // namespace armsig::board
