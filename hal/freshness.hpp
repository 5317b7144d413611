// SPDX-License-Identifier: MIT
// Tells a sensor that is silent from one that repeats itself, by time and sequence number.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "core/base/error.hpp"
#include "hal/clock.hpp"

namespace armsig::hal {

struct FreshnessLimits {
  Duration silent_after = std::chrono::milliseconds(500);  // without any valid answer
  Duration stale_after = std::chrono::milliseconds(500);   // without a new sequence number
};

class Freshness {
 public:
  explicit Freshness(const FreshnessLimits& limits) : limits_(limits) {}

  // A valid answer with `sequence` came at `now`; true if it is a new reading.
  bool take(std::uint32_t sequence, Instant now) {
    const bool is_new = !sequence_ || *sequence_ != sequence;
    if (is_new) advanced_at_ = now;
    sequence_ = sequence;
    heard_at_ = now;
    return is_new;
  }

  // The error that is due at `now`: kSensorSilent or kSensorStale, told again after each further
  // time without improvement. The first call begins the wait for the first answer.
  [[nodiscard]] std::optional<Error> overdue(Instant now) {
    if (!heard_at_) heard_at_ = now;
    if (!advanced_at_) advanced_at_ = now;
    if (now - *heard_at_ > limits_.silent_after) {
      heard_at_ = advanced_at_ = now;
      return Error::kSensorSilent;
    }
    if (now - *advanced_at_ > limits_.stale_after && sequence_) {
      advanced_at_ = now;
      return Error::kSensorStale;
    }
    return std::nullopt;
  }

 private:
  FreshnessLimits limits_;
  std::optional<std::uint32_t> sequence_;
  std::optional<Instant> heard_at_;
  std::optional<Instant> advanced_at_;
};

}  // namespace armsig::hal
