// SPDX-License-Identifier: MIT
// The two threads that a controller is run by, in real time.
#pragma once

#include <csignal>
#include <functional>
#include <span>

#include "firmware/controller/controller.hpp"
#include "firmware/linux/journal.hpp"
#include "firmware/linux/process_watch.hpp"
#include "hal/canopen/master.hpp"
#include "hal/clock.hpp"
#include "hal/linux/socket_can.hpp"

namespace armsig::daemon {

struct RealTimeLoop {
  controller::Controller& controller;
  hal::Clock& clock;  // of the ticks
  hal::Duration period{};
  int priority = 0;  // SCHED_FIFO of the ticks, where permitted; 0: ordinary scheduling
  ProcessWatch& watch;
  Journal& journal;
  std::span<linux_hal::SocketCan* const> buses = {};  // of the drives; none where emulated
  const canopen::Master* master = nullptr;            // on those buses
};

// The servo tick is the calling thread's; everything else is another's, which ends with this call.
// Calls `started` before the first tick, and `bring_to_rest` when `stop` is set, at once: the other
// thread may be waiting for a disk, and is waited for only after that. What is not permitted is
// told in the log; false if there was no second thread to have, told too.
[[nodiscard]] bool run_in_real_time(const RealTimeLoop& loop, const std::function<void()>& started,
                                    const std::function<void()>& bring_to_rest,
                                    const volatile std::sig_atomic_t& stop);

}  // namespace armsig::daemon
