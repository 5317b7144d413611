// SPDX-License-Identifier: MIT
// Signals that would end the process bring the arm to rest first.
#pragma once

#include <csignal>

namespace armsig::daemon {

// From now on every signal that ends a process by default, is no mistake of the program's own, and
// can be caught, sets what is returned to its number: SIGTERM, SIGINT, SIGHUP (the terminal is
// gone), SIGQUIT, timers, limits, user-defined and real-time ones. SIGPIPE and those that suspend a
// process are ignored: ticks that cease stop the drives by their own supervision, in no good way.
// After SIGKILL, or a mistake of ours (SIGSEGV, SIGABRT, ...), nothing of the process is trusted to
// stop the arm: drives that watch their master miss its heartbeat, and stop by themselves.
[[nodiscard]] const volatile std::sig_atomic_t& catch_signals();

}  // namespace armsig::daemon
