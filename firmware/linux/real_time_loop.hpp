// SPDX-License-Identifier: MIT
// The two threads that a controller is run by, in real time.
#pragma once

#include <csignal>
#include <functional>

#include "firmware/controller/controller.hpp"
#include "firmware/linux/process_watch.hpp"
#include "hal/clock.hpp"

namespace armsig::daemon {

struct RealTimeLoop {
  controller::Controller& controller;
  hal::Clock& clock;  // of the ticks
  hal::Duration period{};
  int priority = 0;  // SCHED_FIFO of the ticks, where permitted; 0: ordinary scheduling
  ProcessWatch& watch;
};

// The servo tick is the calling thread's; everything else is another's, which ends with this call.
// Calls `started` before the first tick; what is not permitted is told on standard error. Returns
// when `stop` is set; false if there was no second thread to have, told too.
[[nodiscard]] bool run_in_real_time(const RealTimeLoop& loop, const std::function<void()>& started,
                                    const volatile std::sig_atomic_t& stop);

}  // namespace armsig::daemon
