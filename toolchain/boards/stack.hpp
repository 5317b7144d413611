// SPDX-License-Identifier: MIT
// The stack is painted before main, so that its high-water mark can be read at any time; the lowest
// words are a guard that nothing may ever touch.
#pragma once

#include <cstddef>
#include <cstdint>

// From the linker script.
extern "C" {
// NOLINTBEGIN(readability-identifier-naming)
extern std::uint32_t armsig_stack_bottom[];
extern std::uint32_t armsig_stack_top[];
// NOLINTEND(readability-identifier-naming)
}

namespace armsig::board {

inline constexpr std::uint32_t kStackPaint = 0xA5C3'96E1;
inline constexpr std::size_t kGuardWords = 16;

// From the bottom up to the stack pointer of the caller.
[[gnu::always_inline]] inline void paint_stack() {
  auto* const end = static_cast<std::uint32_t*>(__builtin_frame_address(0)) - kGuardWords;
  for (volatile std::uint32_t* word = armsig_stack_bottom; word < end; ++word) *word = kStackPaint;
}

[[nodiscard]] inline bool stack_guard_intact() {
  for (std::size_t i = 0; i < kGuardWords; ++i) {
    if (armsig_stack_bottom[i] != kStackPaint) return false;
  }
  return true;
}

// Bytes that the stack has needed so far, at most.
[[nodiscard]] inline std::size_t stack_used() {
  const std::uint32_t* word = armsig_stack_bottom;
  while (word < armsig_stack_top && *word == kStackPaint) ++word;
  return static_cast<std::size_t>(armsig_stack_top - word) * sizeof(std::uint32_t);
}

}  // namespace armsig::board
