// SPDX-License-Identifier: MIT
// Regions of the memory protection unit (DDI 0460, 7.2), which each image defines for itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace armsig::board {

// Region access control register: execute never, access permission, type.
enum Access : std::uint32_t {
  kReadOnly = 1U << 12 | 5U << 8 | 0b001'011,  // even for privileged code
  kDevice = 1U << 12 | 3U << 8 | 0b000'001,    // read and write, shared device
  kData = 1U << 12 | 3U << 8 | 0b001'011,      // write-back, write and read allocate
  kShared = 1U << 12 | 3U << 8 | 0b001'100,    // not cached: another core looks at it
  kCode = 6U << 8 | 0b001'011,                 // read only, cached
  kCodeUncached = 6U << 8 | 0b001'000,         // tightly coupled: as fast as a cache
};

struct Region {
  std::uint32_t base;
  std::uint32_t size_log2;
  Access access;
  std::uint8_t without;  // eighths that the region does not cover, from bit 0
};

// An image defines its table as `extern "C" constexpr RegionTable<N> armsig_mpu_regions`, a symbol
// that toolchain/memory_map.py holds its sections against.
template <std::size_t kCount>
using RegionTable = std::array<Region, kCount>;
static_assert(sizeof(Region) == 16);

inline constexpr std::uint32_t kStackGuardLog2 = 8;

// Of this image, at most 15; what none covers may not be touched.
[[nodiscard]] std::span<const Region> regions();

}  // namespace armsig::board
