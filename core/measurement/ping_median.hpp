// SPDX-License-Identifier: MIT
// Several pings at one standstill of the arm: the median per receiver.
//
// The median, not the mean: one reflected ping in a few must not move the range.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/error.hpp"
#include "core/measurement/ranges.hpp"

namespace armsig::measurement {

inline constexpr std::size_t kMaxPings = 16;

// 1 sigma of the median of `count` normal values of unit sigma, 1 <= count <= kMaxPings; exact, by
// integration over the joint density of the middle order statistics (the median of an even count is
// the mean of its middle two). It tends to sqrt(pi / 2 / count) = 1.2533 / sqrt(count), which for
// eight values is 8 % too large.
[[nodiscard]] double median_sigma(std::size_t count);

class PingMedian {
 public:
  explicit PingMedian(std::size_t receivers);

  // One ping: a range per receiver, sigma_factor 1.
  // Errors: kCapacityExceeded after kMaxPings; kNotFinite (a valid range). Nothing is stored then.
  [[nodiscard]] Result<void> add(const Ranges& ping);

  [[nodiscard]] std::size_t pings() const { return pings_; }
  // How many pings receiver `j` heard.
  [[nodiscard]] std::size_t heard(std::size_t j) const { return heard_[j]; }

  // The median range per receiver with the sigma_factor of a median of that many; invalid where
  // fewer than half of the pings were heard.
  [[nodiscard]] Ranges median() const;

 private:
  FixedVector<std::size_t, kMaxReceivers> heard_;
  std::size_t pings_ = 0;
  std::array<std::array<double, kMaxPings>, kMaxReceivers> metres_{};
};

}  // namespace armsig::measurement
