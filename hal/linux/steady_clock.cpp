// SPDX-License-Identifier: MIT
#include "hal/linux/steady_clock.hpp"

#include <sched.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <ctime>

namespace armsig::linux_hal {

using std::chrono::nanoseconds;
using std::chrono::seconds;

hal::Instant monotonic_now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return hal::Instant(seconds(time.tv_sec) + nanoseconds(time.tv_nsec));
}

hal::Duration SteadyClock::do_wait_until(hal::Instant tick) {
  const auto since = tick.time_since_epoch();
  const auto whole = std::chrono::duration_cast<seconds>(since);
  const timespec time{.tv_sec = whole.count(), .tv_nsec = (since - whole).count()};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
  // Where the kernel refuses, a busy processor is better than ticks that come before their time.
  while (monotonic_now() < tick) sched_yield();
  return std::max(hal::Duration::zero(), monotonic_now() - tick);
}

std::int64_t SteadyClock::do_calendar_s() { return std::time(nullptr); }

}  // namespace armsig::linux_hal
