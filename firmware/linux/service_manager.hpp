// SPDX-License-Identifier: MIT
// What systemd wants to hear from a service (sd_notify(3)), without its library: a datagram to the
// socket that the environment names. Elsewhere nothing is sent.
#pragma once

#include <sys/un.h>

#include <optional>
#include <string_view>

#include "hal/clock.hpp"
#include "hal/linux/file_descriptor.hpp"

namespace armsig::daemon {

class ServiceManager {
 public:
  // Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  ServiceManager();

  void ready() { send("READY=1"); }
  void stopping() { send("STOPPING=1"); }
  // The service is well at `now`. Sent twice in the time that the manager allows; not called for
  // longer than that, it ends the process and starts it anew.
  void alive(hal::Instant now);

  // Empty: the manager does not watch.
  [[nodiscard]] std::optional<hal::Duration> watchdog() const { return watchdog_; }

 private:
  void send(std::string_view words);

  linux_hal::FileDescriptor socket_;
  sockaddr_un address_{};
  unsigned address_size_ = 0;
  std::optional<hal::Duration> watchdog_;
  hal::Instant told_at_;
};

}  // namespace armsig::daemon
