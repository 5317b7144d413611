// SPDX-License-Identifier: MIT
// armsigd: the controller of a cabinet on embedded Linux.
#pragma once

#include <csignal>

#include "firmware/linux/daemon_configuration.hpp"
#include "hal/nonvolatile_memory.hpp"

namespace armsig::daemon {

// Of the file that keeps the signatures: two slots of a sector each.
inline constexpr hal::MemoryLayout kStoreLayout{
    .page_bytes = 256, .pages_per_sector = 16, .sectors = 2};

// Runs the controller on its CAN interface until `stop` is set, then brings the drives to rest.
// The servo tick is the calling thread's, under SCHED_FIFO where that is permitted; console,
// sensor, sequences and store are another's. Returns the exit status of the process: 1 when
// something that it needs could not be opened, which is told on standard error.
[[nodiscard]] int run_cabinet(const DaemonConfiguration& configuration,
                              const volatile std::sig_atomic_t& stop);

}  // namespace armsig::daemon
