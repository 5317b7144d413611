// SPDX-License-Identifier: MIT
#include "core/measurement/ping_median.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::measurement {

double median_sigma(std::size_t count) {
  // NOLINTBEGIN(modernize-use-std-numbers): one of them happens to be near 1/pi.
  static constexpr std::array<double, kMaxPings> kSigma = {
      1.000000, 0.707107, 0.669829, 0.546077, 0.535569, 0.463405, 0.458745, 0.410102,
      0.407555, 0.371928, 0.370354, 0.342813, 0.341759, 0.319646, 0.318896, 0.300636};
  // NOLINTEND(modernize-use-std-numbers)
  ARMSIG_CHECK(count >= 1);
  ARMSIG_CHECK(count <= kMaxPings);
  return kSigma[count - 1];
}

PingMedian::PingMedian(std::size_t receivers) : heard_(receivers) {}

Result<void> PingMedian::add(const Ranges& ping) {
  ARMSIG_CHECK(ping.size() == heard_.size());
  if (pings_ == kMaxPings) return std::unexpected(Error::kCapacityExceeded);
  for (const Range& range : ping)
    if (range.valid && !std::isfinite(range.metres)) return std::unexpected(Error::kNotFinite);
  for (std::size_t j = 0; j < ping.size(); ++j)
    if (ping[j].valid) metres_[j][heard_[j]++] = ping[j].metres;
  ++pings_;
  return {};
}

Ranges PingMedian::median() const {
  Ranges ranges;
  for (std::size_t j = 0; j < heard_.size(); ++j) {
    const std::size_t count = heard_[j];
    if (count == 0 || 2 * count < pings_) {
      ranges.push_back({});
      continue;
    }
    std::array<double, kMaxPings> sorted = metres_[j];
    std::sort(sorted.begin(), sorted.begin() + count);
    ranges.push_back({.metres = 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]),
                      .valid = true,
                      .sigma_factor = median_sigma(count)});
  }
  return ranges;
}

}  // namespace armsig::measurement
