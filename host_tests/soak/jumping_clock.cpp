// SPDX-License-Identifier: MIT
// Preloaded: the calendar's clock jumps by an hour or a day, forth and back, at every look; the
// monotonic one goes on.
#include <dlfcn.h>

#include <atomic>
#include <ctime>

extern "C" int clock_gettime(clockid_t clock, struct timespec* now) noexcept {
  using ClockGettime = int (*)(clockid_t, struct timespec*);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): what dlsym is for
  static const auto next = reinterpret_cast<ClockGettime>(::dlsym(RTLD_NEXT, "clock_gettime"));
  static std::atomic<unsigned> looks{0};
  const int result = next(clock, now);
  if (result != 0 || clock != CLOCK_REALTIME) return result;
  constexpr std::time_t kHour = 3600;
  constexpr std::time_t kJumps[]{0, kHour, -kHour, 24 * kHour, -24 * kHour};
  now->tv_sec += kJumps[looks.fetch_add(1) % 5];
  return 0;
}
