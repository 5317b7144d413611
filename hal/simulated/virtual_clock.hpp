// SPDX-License-Identifier: MIT
// Time that passes only when it is waited for, and moves a simulated world as it passes.
#pragma once

#include <cstddef>

#include "core/base/fixed_vector.hpp"
#include "hal/clock.hpp"

namespace armsig::simulated {

// Something that changes with time.
class TimeDriven {
 public:
  // Brings the object to `until`, which is never before the last one.
  void advance(hal::Instant until) { do_advance(until); }

 protected:
  ~TimeDriven() = default;

 private:
  virtual void do_advance(hal::Instant until) = 0;
};

class VirtualClock final : public hal::Clock {
 public:
  static constexpr std::size_t kMaxDriven = 8;

  // `driven` must outlive the clock; things are advanced in the order in which they were added.
  void add(TimeDriven& driven) { driven_.push_back(&driven); }

 private:
  hal::Instant do_now() override { return now_; }
  hal::Duration do_wait_until(hal::Instant tick) override {
    if (tick <= now_) return now_ - tick;
    for (TimeDriven* driven : driven_) driven->advance(tick);
    now_ = tick;
    return {};
  }

  hal::Instant now_;
  FixedVector<TimeDriven*, kMaxDriven> driven_;
};

}  // namespace armsig::simulated
