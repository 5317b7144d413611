// SPDX-License-Identifier: MIT
#include "firmware/linux/drive_look.hpp"

#include <chrono>
#include <cstdio>

#include <fmt/format.h>

#include "firmware/linux/drive_scan.hpp"
#include "firmware/linux/drive_words.hpp"
#include "hal/linux/socket_can.hpp"
#include "hal/linux/steady_clock.hpp"

namespace armsig::daemon {

int look_at_drives(const DaemonConfiguration& configuration, bool as_json,
                   const volatile std::sig_atomic_t& stop) {
  const auto drives = canopen::check(configuration.drives);
  if (!drives) return 1;  // refused when the file was read
  linux_hal::SteadyClock clock;
  linux_hal::SocketCan bus(
      {.interface_name = configuration.can_interface, .filters = {}, .maintained = false});
  DriveScan scan(*drives, bus);
  const auto is_down = [&] {
    const hal::CanState state = bus.status().state;
    return state == hal::CanState::kDown || state == hal::CanState::kBusOff;
  };
  hal::Instant next = clock.now();
  do {
    if (is_down()) {
      fmt::print(stderr, "armsigd: {}: {}\n", configuration.can_interface,
                 describe(Error::kBusDown));
      return 1;
    }
    next += std::chrono::milliseconds(1);
    clock.wait_until(next);
  } while (stop == 0 && scan.step(clock.now()));
  if (scan.is_stuck()) {
    fmt::print(stderr, "armsigd: {}: {}\n", configuration.can_interface, describe(Error::kBusBusy));
    return 1;
  }
  fmt::print("{}", as_json ? drives_as_json(scan, *drives) : drives_in_words(scan, *drives));
  return all_would_be_set_up(scan.nodes(), *drives) ? 0 : 1;
}

}  // namespace armsig::daemon
