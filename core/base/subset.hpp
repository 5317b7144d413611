// SPDX-License-Identifier: MIT
// Subsets of a few things (joints, receivers) as the bits of a number: bit i is thing i.
#pragma once

#include <cstddef>
#include <cstdint>

namespace armsig {

using Subset = std::uint32_t;

[[nodiscard]] constexpr bool contains(Subset set, std::size_t i) { return ((set >> i) & 1U) != 0; }

// The next larger number with as many bits set: what enumerates the subsets of a size, from
// (1 << size) - 1 on. Larger than any subset of n things after their last one. Precondition: not
// empty.
[[nodiscard]] constexpr Subset next_of_as_many(Subset set) {
  const Subset lowest = set & (~set + 1);
  const Subset carried = set + lowest;
  return carried | (((set ^ carried) >> 2) / lowest);
}

}  // namespace armsig
