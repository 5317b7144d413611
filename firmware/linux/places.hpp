// SPDX-License-Identifier: MIT
// The store and the consoles of a cabinet, or why they cannot be opened.
#pragma once

#include <memory>
#include <optional>

#include "firmware/linux/daemon_configuration.hpp"
#include "hal/linux/file_memory.hpp"
#include "hal/linux/socket_console.hpp"

namespace armsig::daemon {

struct Places {
  linux_hal::FileMemory store;
  std::unique_ptr<linux_hal::SocketConsole> console;
  std::unique_ptr<linux_hal::SocketConsole> reporting;  // or none
};

// All open and this process's alone; nothing where one is refused, which standard error tells in
// the words of who has to mend it.
[[nodiscard]] std::optional<Places> open_places(const DaemonConfiguration& configuration);

}  // namespace armsig::daemon
