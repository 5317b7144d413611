// SPDX-License-Identifier: MIT
// armsigd: the controller of a cabinet on embedded Linux.
#pragma once

#include <csignal>

#include "firmware/linux/daemon_configuration.hpp"
#include "hal/linux/file_memory.hpp"

namespace armsig::daemon {

// Of the file that keeps the signatures: three banks of three sectors (record_store.hpp), and one
// sector more for the positions at power-down. Banks lie in erase blocks of their own on any card.
inline constexpr hal::MemoryLayout kStoreLayout{
    .page_bytes = 256, .pages_per_sector = 8, .sectors = 10};
inline constexpr linux_hal::FileSpread kStoreSpread{.sectors = 3,
                                                    .stride_bytes = std::size_t{4} << 20U};

// Runs the controller on its CAN interface until `stop` is set, then brings the drives to rest.
// The servo tick is the calling thread's, under SCHED_FIFO where that is permitted; console,
// sensor, sequences and store are another's. Returns the exit status of the process: 1 when
// something that it needs could not be opened, which is told on standard error.
[[nodiscard]] int run_cabinet(const DaemonConfiguration& configuration,
                              const volatile std::sig_atomic_t& stop);

}  // namespace armsig::daemon
