// SPDX-License-Identifier: MIT
// What a program finds in memory when it begins: initial values copied, the rest zero.
#pragma once

#include <cstdint>

// From the linker script; all on boundaries of eight bytes.
extern "C" {
// NOLINTBEGIN(readability-identifier-naming)
extern std::uint32_t armsig_data_begin[];
extern std::uint32_t armsig_data_end[];
extern const std::uint32_t armsig_data_image[];
extern std::uint64_t armsig_bss_begin[];
extern std::uint64_t armsig_bss_end[];
// NOLINTEND(readability-identifier-naming)
}

namespace armsig::board {

[[gnu::always_inline]] inline void initialise_memory() {
  const std::uint32_t* from = armsig_data_image;
  for (volatile std::uint32_t* to = armsig_data_begin; to < armsig_data_end; ++to) *to = *from++;
  // Memory with error correction knows words of eight bytes, and none of them before it is written
  // as a whole.
  for (volatile std::uint64_t* to = armsig_bss_begin; to < armsig_bss_end; ++to) *to = 0;
}

}  // namespace armsig::board
