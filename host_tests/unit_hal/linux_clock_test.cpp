// SPDX-License-Identifier: MIT
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

#include <gtest/gtest.h>

#include "hal/linux/back_off.hpp"
#include "hal/linux/real_time.hpp"
#include "hal/linux/steady_clock.hpp"
#include "host_tests/support/range_readings.hpp"

namespace armsig::linux_hal {
namespace {

using std::chrono::milliseconds;
using test::at_ms;

TEST(SteadyClock, wakes_at_the_tick_and_tells_its_lateness) {
  SteadyClock clock;
  const hal::Instant tick = clock.now() + milliseconds(5);
  const hal::Duration late = clock.wait_until(tick);
  const hal::Instant after = clock.now();
  EXPECT_GE(after, tick);
  EXPECT_GE(late, hal::Duration::zero());
  EXPECT_LE(tick + late, after);
}

TEST(SteadyClock, returns_at_once_from_a_tick_in_the_past) {
  SteadyClock clock;
  const hal::Duration late = clock.wait_until(clock.now() - milliseconds(10));
  EXPECT_GE(late, milliseconds(10));
}

TEST(BackOff, doubles_up_to_its_longest_and_starts_anew_after_success) {
  BackOff back_off;
  EXPECT_TRUE(back_off.due(at_ms(0)));
  back_off.fail(at_ms(0));
  EXPECT_FALSE(back_off.due(at_ms(99)));
  EXPECT_TRUE(back_off.due(at_ms(100)));
  back_off.fail(at_ms(100));
  EXPECT_FALSE(back_off.due(at_ms(299)));
  EXPECT_TRUE(back_off.due(at_ms(300)));
  for (int i = 0; i < 10; ++i) back_off.fail(at_ms(300));
  EXPECT_FALSE(back_off.due(at_ms(3499)));
  EXPECT_TRUE(back_off.due(at_ms(3500)));
  back_off.succeed();
  back_off.fail(at_ms(4000));
  EXPECT_TRUE(back_off.due(at_ms(4100)));
}

// In a process of its own, because it changes the process for good.
int in_child(int (*body)()) {
  const pid_t child = fork();
  if (child == 0) _exit(body());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(RealTime, reports_what_is_not_permitted_and_goes_on) {
  if (geteuid() != 0) GTEST_SKIP() << "giving up rights needs to have them";
  EXPECT_EQ(in_child([] {
              const rlimit nothing{0, 0};
              setrlimit(RLIMIT_MEMLOCK, &nothing);
              setrlimit(RLIMIT_RTPRIO, &nothing);
              if (setuid(65534) != 0) return 2;
              const RealTimeReport report = become_real_time(50);
              return report.memory_not_locked && report.priority_not_given && !report.granted() ? 0
                                                                                                : 1;
            }),
            0);
}

TEST(RealTime, reports_the_scheduling_that_the_kernel_reports) {
  EXPECT_EQ(in_child([] {
              const RealTimeReport report = become_real_time(1);
              const bool fifo = sched_getscheduler(0) == SCHED_FIFO;
              return fifo == !report.priority_not_given.has_value() ? 0 : 1;
            }),
            0);
}

}  // namespace
}  // namespace armsig::linux_hal
