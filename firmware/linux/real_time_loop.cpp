// SPDX-License-Identifier: MIT
#include "firmware/linux/real_time_loop.hpp"

#include <atomic>
#include <cstring>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "hal/linux/real_time.hpp"
#include "hal/linux/steady_clock.hpp"

namespace armsig::daemon {
namespace {

constexpr unsigned kTicksBetweenLooks = 256;

void warn_about(const linux_hal::RealTimeReport& report, Journal& journal) {
  const auto warn = [&](std::string_view advice, int number) {
    journal.tell(Priority::kWarning, fmt::format("warning: {}: {}", advice, std::strerror(number)));
  };
  if (report.memory_not_locked) warn(linux_hal::kMemoryAdvice, *report.memory_not_locked);
  if (report.priority_not_given) warn(linux_hal::kPriorityAdvice, *report.priority_not_given);
}

// The thread of everything but the tick, until it is destroyed.
class BackgroundThread {
 public:
  // Looks once a period, short against anything that a person or a sensor notices, and computes for
  // half of it where there is something to compute.
  explicit BackgroundThread(const RealTimeLoop& loop)
      : thread_([this, &loop] {
          linux_hal::SteadyClock clock;
          while (!stop_) {
            const hal::Instant half = clock.now() + loop.period / 2;
            while (loop.controller.background() && clock.now() < half) {
            }
            for (linux_hal::SocketCan* bus : loop.buses) bus->maintain();
            loop.watch.stepped();
            clock.wait_until(half + loop.period / 2);
          }
        }) {}
  ~BackgroundThread() {
    stop_ = true;
    thread_.join();
  }
  BackgroundThread(const BackgroundThread&) = delete;
  BackgroundThread& operator=(const BackgroundThread&) = delete;

 private:
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

// Ticks keep to the grid that the first one lays; those that were missed are left out.
void serve(const RealTimeLoop& loop, const volatile std::sig_atomic_t& stop) {
  hal::Instant next = loop.clock.now() + loop.period;
  unsigned ticks = 0;
  while (stop == 0) {
    const hal::Duration lateness = loop.clock.wait_until(next);
    loop.controller.tick(lateness);
    loop.watch.ticked();
    if (ticks++ % kTicksBetweenLooks == 0) loop.watch.look(loop.buses, loop.master);
    next += loop.period * (1 + lateness / loop.period);
  }
}

}  // namespace

bool run_in_real_time(const RealTimeLoop& loop, const std::function<void()>& started,
                      const std::function<void()>& bring_to_rest,
                      const volatile std::sig_atomic_t& stop) {
  try {
    const BackgroundThread background(loop);
    const linux_hal::RealTimeReport report = linux_hal::become_real_time(loop.priority);
    warn_about(report, loop.journal);
    started();
    loop.watch.begin(report, loop.priority);
    serve(loop, stop);
    bring_to_rest();
  } catch (const std::system_error& error) {
    loop.journal.tell(Priority::kError, fmt::format("thread: {}", error.what()));
    return false;
  }
  return true;
}

}  // namespace armsig::daemon
