// SPDX-License-Identifier: MIT
// What a process asks of Linux so that its ticks come in time.
#pragma once

#include <optional>
#include <string_view>

namespace armsig::linux_hal {

// What was not permitted, as errno values; empty: granted. Nothing of it is fatal: the ticks come
// later then, and the daemon says so.
struct RealTimeReport {
  std::optional<int> memory_not_locked;
  std::optional<int> priority_not_given;

  [[nodiscard]] bool granted() const { return !memory_not_locked && !priority_not_given; }
};

// Locks all memory, present and future, touches the stack that ticks will use, keeps the allocator
// from giving memory back, and puts the calling thread under SCHED_FIFO at `priority` (1 to 99; 0
// leaves it as it is). Call it from the thread of the servo loop when everything else is started:
// other threads keep their scheduling, and an unprivileged process may be unable to map more memory
// afterwards.
[[nodiscard]] RealTimeReport become_real_time(int priority);

// A sentence for an operator about a missing permission.
inline constexpr std::string_view kMemoryAdvice =
    "memory is not locked: page faults may delay ticks (grant CAP_IPC_LOCK or raise LimitMEMLOCK)";
inline constexpr std::string_view kPriorityAdvice =
    "no real-time priority: other processes may delay ticks (grant CAP_SYS_NICE or raise "
    "LimitRTPRIO)";

}  // namespace armsig::linux_hal
