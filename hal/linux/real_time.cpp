// SPDX-License-Identifier: MIT
#include "hal/linux/real_time.hpp"

#include <malloc.h>
#include <sched.h>
#include <string.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstddef>

namespace armsig::linux_hal {
namespace {

// Far more than the calls of a tick need, and little of the 8 MiB that a main thread has.
constexpr std::size_t kStackBytes = std::size_t{256} * 1024;

void touch_stack() {
  std::byte stack[kStackBytes];
  explicit_bzero(stack, sizeof stack);  // not left out by the compiler, as a plain one would be
}

}  // namespace

RealTimeReport become_real_time(int priority) {
  RealTimeReport report;
  // Freed memory stays with the process, and large blocks come from it, so that a later use of the
  // heap outside the tick causes no page fault inside it.
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) report.memory_not_locked = errno;
  touch_stack();
  if (priority == 0) return report;
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) report.priority_not_given = errno;
  return report;
}

}  // namespace armsig::linux_hal
