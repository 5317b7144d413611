// SPDX-License-Identifier: MIT
// Monotonic time and the tick that is waited for.
#pragma once

#include <chrono>
#include <cstdint>

namespace armsig::hal {

using Duration = std::chrono::nanoseconds;

// The pseudo-clock that every Instant is told in; its epoch is the backend's, usually the power-up.
struct MonotonicTime {};
using Instant = std::chrono::time_point<MonotonicTime, Duration>;

[[nodiscard]] constexpr double seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

class Clock {
 public:
  // Never runs backwards. No errors.
  [[nodiscard]] Instant now() { return do_now(); }

  // Returns at `tick` or as soon after it as the platform can, with the lateness (never negative).
  // A tick in the past returns at once. No errors.
  Duration wait_until(Instant tick) { return do_wait_until(tick); }

  // The calendar's time, seconds since 1970-01-01 UTC, for records only: it may jump. 0: not known.
  // No errors.
  [[nodiscard]] std::int64_t calendar_s() { return do_calendar_s(); }

 protected:
  ~Clock() = default;

 private:
  virtual Instant do_now() = 0;
  virtual Duration do_wait_until(Instant tick) = 0;
  virtual std::int64_t do_calendar_s() { return 0; }
};

}  // namespace armsig::hal
