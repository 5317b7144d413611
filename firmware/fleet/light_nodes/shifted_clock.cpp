// SPDX-License-Identifier: MIT
// Preloaded by toolchain/fleet: a computer whose clock is ARMSIG_CLOCK_SHIFT_S seconds off. Only
// clock_gettime() is: certificates are looked at by time(), and would have to be older than the
// fleet.
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>

extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const long result = ::syscall(SYS_clock_gettime, clock, time);
  if (result == 0 && clock == CLOCK_REALTIME) {
    const char* shift = std::getenv("ARMSIG_CLOCK_SHIFT_S");
    if (shift != nullptr) time->tv_sec += std::strtol(shift, nullptr, 10);
  }
  return static_cast<int>(result);
}
