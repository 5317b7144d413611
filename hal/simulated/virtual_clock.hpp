// SPDX-License-Identifier: MIT
// Time that moves a simulated world as it passes: only when it is waited for, or with a real clock.
#pragma once

#include <algorithm>
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

  VirtualClock() = default;
  // Time since now of `real`, which outlives this clock: whoever waits is as late as on `real`.
  // Then now() may be asked by any thread, if that of `real` may.
  explicit VirtualClock(hal::Clock& real) : real_(&real), origin_(real.now()) {}

  // `driven` must outlive the clock; things are advanced in the order in which they were added.
  void add(TimeDriven& driven) { driven_.push_back(&driven); }

 private:
  hal::Instant do_now() override { return real_ ? hal::Instant(real_->now() - origin_) : now_; }
  hal::Duration do_wait_until(hal::Instant tick) override {
    hal::Instant reached = std::max(tick, now_);
    if (real_) reached = tick + real_->wait_until(origin_ + tick.time_since_epoch());
    for (TimeDriven* driven : driven_) driven->advance(reached);
    now_ = reached;
    return reached - tick;
  }

  hal::Clock* real_ = nullptr;
  hal::Instant origin_;
  hal::Instant now_;  // of the world
  FixedVector<TimeDriven*, kMaxDriven> driven_;
};

}  // namespace armsig::simulated
