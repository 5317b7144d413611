// SPDX-License-Identifier: MIT
#include "firmware/linux/daemon.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "firmware/controller/controller.hpp"
#include "firmware/linux/can_sensor.hpp"
#include "firmware/linux/process_watch.hpp"
#include "firmware/linux/shut_down.hpp"
#include "firmware/linux/system_console.hpp"
#include "hal/canopen/master.hpp"
#include "hal/linux/file_memory.hpp"
#include "hal/linux/real_time.hpp"
#include "hal/linux/rtu_range_sensor.hpp"
#include "hal/linux/socket_can.hpp"
#include "hal/linux/socket_console.hpp"
#include "hal/linux/steady_clock.hpp"

namespace armsig::daemon {
namespace {

constexpr unsigned kTicksBetweenLooks = 256;

void complain(std::string_view what, std::string_view why) {
  fmt::print(stderr, "armsigd: {}: {}\n", what, why);
}

// The sensor, on whichever bus it is.
struct SensorBackend {
  std::unique_ptr<linux_hal::RtuRangeSensor> serial;
  std::unique_ptr<CanSensor> can;

  [[nodiscard]] hal::RangeSensor& sensor() const {
    if (serial) return *serial;
    return *can;
  }
};

Result<SensorBackend> start_sensor(const DaemonConfiguration& configuration) {
  SensorBackend backend;
  if (const auto* node = std::get_if<canopen::RangeNodeConfiguration>(&configuration.sensor)) {
    backend.can = std::make_unique<CanSensor>(*node);
    return backend;
  }
  auto started = linux_hal::RtuRangeSensor::start(
      std::get<linux_hal::RtuRangeSensorConfiguration>(configuration.sensor));
  if (!started) return std::unexpected(started.error());
  backend.serial = std::move(*started);
  return backend;
}

void warn_about(const linux_hal::RealTimeReport& report) {
  const auto warn = [](std::string_view advice, int number) {
    fmt::print(stderr, "armsigd: warning: {}: {}\n", advice, std::strerror(number));
  };
  if (report.memory_not_locked) warn(linux_hal::kMemoryAdvice, *report.memory_not_locked);
  if (report.priority_not_given) warn(linux_hal::kPriorityAdvice, *report.priority_not_given);
}

// The thread of everything but the tick, until it is destroyed.
class BackgroundThread {
 public:
  // Looks once a period, short against anything that a person or a sensor notices, and computes for
  // half of it where there is something to compute.
  BackgroundThread(controller::Controller& controller, hal::Duration period)
      : thread_([this, &controller, period] {
          linux_hal::SteadyClock clock;
          while (!stop_) {
            const hal::Instant half = clock.now() + period / 2;
            while (controller.background() && clock.now() < half) {
            }
            clock.wait_until(half + period / 2);
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
void serve(controller::Controller& controller, hal::Clock& clock, hal::Duration period,
           ProcessWatch& watch, const volatile std::sig_atomic_t& stop) {
  hal::Instant next = clock.now() + period;
  for (unsigned ticks = 0; stop == 0; ++ticks) {
    const hal::Duration lateness = clock.wait_until(next);
    controller.tick(lateness);
    if (ticks % kTicksBetweenLooks == 0) watch.look();
    next += period * (1 + lateness / period);
  }
}

}  // namespace

int run_cabinet(const DaemonConfiguration& configuration, const volatile std::sig_atomic_t& stop) {
  const auto drives = canopen::check(configuration.drives);
  if (!drives) return 1;  // refused when the file was read
  auto memory = linux_hal::FileMemory::open(configuration.store, kStoreLayout);
  if (!memory) {
    complain(configuration.store, describe(memory.error()));
    return 1;
  }
  auto socket = linux_hal::SocketConsole::open(configuration.console);
  if (!socket) {
    complain(configuration.console, describe(socket.error()));
    return 1;
  }
  auto backend = start_sensor(configuration);
  if (!backend) {
    complain("sensor", describe(backend.error()));
    return 1;
  }

  ProcessWatch watch;
  SystemConsole console(**socket, watch);
  const std::array<hal::Console*, 1> consoles{&console};
  linux_hal::SteadyClock clock;
  linux_hal::SocketCan bus({.interface_name = configuration.can_interface, .filters = {}});
  canopen::Master master(*drives, bus, backend->can.get());
  const auto controller = std::make_unique<controller::Controller>(
      configuration.controller, master, backend->sensor(), clock, *memory, consoles);
  try {
    const BackgroundThread background(*controller, configuration.controller.period);
    const linux_hal::RealTimeReport report = linux_hal::become_real_time(configuration.priority);
    warn_about(report);
    fmt::print("armsigd: {}: {} joints on {}, console at {}\n", configuration.name,
               configuration.drives.axes.size(), configuration.can_interface,
               configuration.console);
    std::fflush(stdout);
    watch.begin(report, configuration.priority);
    serve(*controller, clock, configuration.controller.period, watch, stop);
    shut_down(master, clock, configuration.controller.period);
  } catch (const std::system_error& error) {
    complain("thread", error.what());
    return 1;
  }
  return 0;
}

}  // namespace armsig::daemon
