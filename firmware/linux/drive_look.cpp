// SPDX-License-Identifier: MIT
#include "firmware/linux/drive_look.hpp"

#include <chrono>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "firmware/linux/drive_scan.hpp"
#include "firmware/linux/drive_words.hpp"
#include "hal/linux/socket_can.hpp"
#include "hal/linux/steady_clock.hpp"

namespace armsig::daemon {
namespace {

// Until all of one bus is read. False where it is down or takes no frame, which is told.
bool look_at_bus(const std::string& interface, linux_hal::SocketCan& bus, DriveScan& scan,
                 const volatile std::sig_atomic_t& stop) {
  linux_hal::SteadyClock clock;
  const auto is_down = [&] {
    const hal::CanState state = bus.status().state;
    return state == hal::CanState::kDown || state == hal::CanState::kBusOff;
  };
  hal::Instant next = clock.now();
  do {
    if (is_down()) {
      fmt::print(stderr, "armsigd: {}: {}\n", interface, describe(Error::kBusDown));
      return false;
    }
    next += std::chrono::milliseconds(1);
    clock.wait_until(next);
  } while (stop == 0 && scan.step(clock.now()));
  if (!scan.is_stuck()) return true;
  fmt::print(stderr, "armsigd: {}: {}\n", interface, describe(Error::kBusBusy));
  return false;
}

}  // namespace

int look_at_drives(const DaemonConfiguration& configuration, bool as_json,
                   const volatile std::sig_atomic_t& stop) {
  const auto drives = canopen::check(configuration.drives);
  if (!drives) return 1;  // refused when the file was read
  const bool several = configuration.can_interfaces.size() > 1;
  std::vector<DriveScan> scans;
  bool all_set_up = true;
  std::uint8_t number = 0;
  for (const std::string& interface : configuration.can_interfaces) {
    linux_hal::SocketCan bus({.interface_name = interface, .filters = {}, .maintained = false});
    DriveScan scan(*drives, bus, number++, several ? interface : "");
    if (!look_at_bus(interface, bus, scan, stop)) {
      all_set_up = false;  // what another interface says is told all the same
      continue;
    }
    all_set_up = all_set_up && all_would_be_set_up(scan.nodes(), *drives);
    scans.push_back(std::move(scan));
  }
  if (scans.empty()) return 1;
  if (as_json) fmt::print("{}", drives_as_json(scans, *drives));
  for (const DriveScan& scan : scans) {
    if (!as_json) fmt::print("{}", drives_in_words(scan, *drives));
  }
  return all_set_up ? 0 : 1;
}

}  // namespace armsig::daemon
