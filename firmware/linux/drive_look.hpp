// SPDX-License-Identifier: MIT
// armsigd --drives: the drives on each CAN interface, told without a write.
#pragma once

#include <csignal>

#include "firmware/linux/daemon_configuration.hpp"

namespace armsig::daemon {

// Until all is read or `stop` is set. Returns the exit status of the process: 1 where the interface
// is not there or not up, and where a joint has no drive that would be set up.
[[nodiscard]] int look_at_drives(const DaemonConfiguration& configuration, bool as_json,
                                 const volatile std::sig_atomic_t& stop);

}  // namespace armsig::daemon
