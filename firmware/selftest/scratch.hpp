// SPDX-License-Identifier: MIT
// Memory for what the checks need one after the other and what is too large for a stack.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

#include "core/features/sweep_estimator.hpp"

namespace armsig::selftest {

inline constexpr std::size_t kScratchBytes = sizeof(features::SweepEstimator);  // the largest
alignas(32) inline std::array<std::byte, kScratchBytes> scratch;

// A new T, until the next one is made.
template <typename T, typename... Arguments>
[[nodiscard]] T& in_scratch(Arguments&&... arguments) {
  static_assert(sizeof(T) <= kScratchBytes && alignof(T) <= 32);
  static_assert(std::is_trivially_destructible_v<T>);
  void* memory = scratch.data();
  return *std::construct_at(static_cast<T*>(memory), std::forward<Arguments>(arguments)...);
}

}  // namespace armsig::selftest
