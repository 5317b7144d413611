// SPDX-License-Identifier: MIT
// How long something took, in every one of many ticks: counts in bins that double.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "hal/clock.hpp"

namespace armsig::controller {

// Bin 0 counts below 1 microsecond, bin k from 2^(k-1) up to 2^k microseconds, the last all above.
struct Histogram {
  static constexpr std::size_t kBins = 16;
  std::array<std::uint64_t, kBins> counts{};  // of 32 bits they would wrap after 49 days at 1 kHz
  hal::Duration largest{};
  hal::Duration sum{};
  std::uint64_t total = 0;

  void add(hal::Duration duration) {
    const auto whole_us = static_cast<std::uint64_t>(
        std::max<std::int64_t>(0, std::chrono::floor<std::chrono::microseconds>(duration).count()));
    ++counts[std::min<std::size_t>(static_cast<std::size_t>(std::bit_width(whole_us)), kBins - 1)];
    largest = std::max(largest, duration);
    sum += duration;
    ++total;
  }
  [[nodiscard]] double mean_us() const {
    return total == 0 ? 0 : 1e6 * hal::seconds(sum) / static_cast<double>(total);
  }
};

}  // namespace armsig::controller
