// SPDX-License-Identifier: MIT
// When to try again what failed: soon at first, then ever more seldom.
#pragma once

#include <algorithm>
#include <chrono>

#include "hal/clock.hpp"

namespace armsig::linux_hal {

class BackOff {
 public:
  static constexpr hal::Duration kShortest = std::chrono::milliseconds(100);
  static constexpr hal::Duration kLongest = std::chrono::milliseconds(3200);

  // A failure at `now`: the next try is due after the present delay, which then doubles.
  void fail(hal::Instant now) {
    due_ = now + delay_;
    delay_ = std::min(2 * delay_, kLongest);
  }
  [[nodiscard]] bool due(hal::Instant now) const { return now >= due_; }
  [[nodiscard]] hal::Instant due_at() const { return due_; }
  // Lasting success: the next failure is tried again soon.
  void succeed() { delay_ = kShortest; }

 private:
  hal::Duration delay_ = kShortest;
  hal::Instant due_;
};

}  // namespace armsig::linux_hal
