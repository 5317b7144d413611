// SPDX-License-Identifier: MIT
// The clock where the kernel refuses to wait, as a filter of system calls makes it.
#include <dlfcn.h>
#include <time.h>

#include <cerrno>
#include <chrono>

#include <gtest/gtest.h>

#include "hal/linux/steady_clock.hpp"

namespace {
int refusals = 0;  // of the next waits
}  // namespace

extern "C" int clock_nanosleep(clockid_t clock, int flags, const timespec* time, timespec* left) {
  if (refusals > 0) {
    --refusals;
    return EPERM;
  }
  using Call = int (*)(clockid_t, int, const timespec*, timespec*);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): what dlsym is for
  return reinterpret_cast<Call>(::dlsym(RTLD_NEXT, "clock_nanosleep"))(clock, flags, time, left);
}

namespace armsig::linux_hal {
namespace {

// Otherwise ticks would follow each other as fast as the processor goes, and the drives' targets
// with them.
TEST(SteadyClock, comes_back_no_sooner_where_the_kernel_refuses_to_wait) {
  SteadyClock clock;
  for (const int refused : {1, 1000}) {
    refusals = refused;
    const hal::Instant tick = clock.now() + std::chrono::milliseconds(5);
    const hal::Duration late = clock.wait_until(tick);
    EXPECT_LT(refusals, refused) << "none was refused";
    EXPECT_GE(clock.now(), tick);
    EXPECT_GE(late, hal::Duration::zero());
  }
  refusals = 0;
}

}  // namespace
}  // namespace armsig::linux_hal
