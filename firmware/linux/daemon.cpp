// SPDX-License-Identifier: MIT
#include "firmware/linux/daemon.hpp"

#include <array>
#include <cstdio>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "firmware/controller/controller.hpp"
#include "firmware/linux/can_sensor.hpp"
#include "firmware/linux/process_watch.hpp"
#include "firmware/linux/real_time_loop.hpp"
#include "firmware/linux/shut_down.hpp"
#include "firmware/linux/system_console.hpp"
#include "hal/canopen/master.hpp"
#include "hal/linux/file_memory.hpp"
#include "hal/linux/rtu_range_sensor.hpp"
#include "hal/linux/socket_can.hpp"
#include "hal/linux/socket_console.hpp"
#include "hal/linux/steady_clock.hpp"

namespace armsig::daemon {
namespace {

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

}  // namespace

int run_cabinet(const DaemonConfiguration& configuration, const volatile std::sig_atomic_t& stop) {
  const auto drives = canopen::check(configuration.drives);
  if (!drives) return 1;  // refused when the file was read
  auto memory = linux_hal::FileMemory::open(configuration.store, kStoreLayout, kStoreSpread);
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
  const RealTimeLoop loop{.controller = *controller,
                          .clock = clock,
                          .period = configuration.controller.period,
                          .priority = configuration.priority,
                          .watch = watch};
  const bool served = run_in_real_time(
      loop,
      [&] {
        fmt::print("armsigd: {}: {} joints on {}, console at {}\n", configuration.name,
                   configuration.drives.axes.size(), configuration.can_interface,
                   configuration.console);
        std::fflush(stdout);
      },
      stop);
  if (served) {
    shut_down(master, clock, configuration.controller.period);
    controller::keep_positions(*memory, master);
  }
  return served ? 0 : 1;
}

}  // namespace armsig::daemon
