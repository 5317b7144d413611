// SPDX-License-Identifier: MIT
// A number that only depends on the joint readings of a pose: what deals poses to folds, whatever
// their order.
#pragma once

#include <bit>
#include <cstdint>

#include "core/base/arm.hpp"

namespace armsig::calibration {

// `hash` with the bits of one more word mixed in (the finaliser of MurmurHash3, Appleby, 2011).
[[nodiscard]] constexpr std::uint64_t mixed(std::uint64_t hash, std::uint64_t word) {
  hash ^= word;
  hash ^= hash >> 33U;
  hash *= 0xff51afd7ed558ccdU;
  hash ^= hash >> 33U;
  hash *= 0xc4ceb9fe1a85ec53U;
  hash ^= hash >> 33U;
  return hash;
}

inline constexpr std::uint64_t kFirstHash = 0x9e3779b97f4a7c15U;

[[nodiscard]] inline std::uint64_t hash_of(const JointVector& readings) {
  std::uint64_t hash = kFirstHash;
  for (const double reading : readings) {
    hash = mixed(hash, std::bit_cast<std::uint64_t>(reading + 0.0));  // -0 and +0 are one
  }
  return hash;
}

}  // namespace armsig::calibration
