// SPDX-License-Identifier: MIT
// Preloaded by toolchain/fleet: a computer whose clock is ARMSIG_CLOCK_SHIFT_S seconds off. Only
// clock_gettime() is: certificates are looked at by time(), and would have to be older than the
// fleet.
#include <dlfcn.h>

#include <cstdlib>
#include <ctime>

// Another clock that is preloaded, such as faketime's, is asked in place of the computer's.
extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  using Clock = int (*)(clockid_t, timespec*);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): dlsym() knows no types
  static const auto next = reinterpret_cast<Clock>(::dlsym(RTLD_NEXT, "clock_gettime"));
  const int result = next(clock, time);
  if (result == 0 && clock == CLOCK_REALTIME) {
    const char* shift = std::getenv("ARMSIG_CLOCK_SHIFT_S");
    if (shift != nullptr) time->tv_sec += std::strtol(shift, nullptr, 10);
  }
  return result;
}
