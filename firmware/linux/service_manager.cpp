// SPDX-License-Identifier: MIT
#include "firmware/linux/service_manager.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <charconv>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace armsig::daemon {
namespace {

std::optional<long long> number_in(const char* variable) {
  const char* const text = std::getenv(variable);
  if (text == nullptr) return std::nullopt;
  long long value = 0;
  const char* const end = text + std::strlen(text);
  const auto [at, error] = std::from_chars(text, end, value);
  if (error != std::errc() || at != end || value <= 0) return std::nullopt;
  return value;
}

}  // namespace

ServiceManager::ServiceManager() {
  const char* const path = std::getenv("NOTIFY_SOCKET");
  const std::size_t length = path == nullptr ? 0 : std::strlen(path);
  if (length < 2 || length >= sizeof address_.sun_path || (*path != '/' && *path != '@')) return;
  address_.sun_family = AF_UNIX;
  std::memcpy(address_.sun_path, path, length);
  if (*path == '@') address_.sun_path[0] = '\0';  // an abstract one
  address_size_ = static_cast<unsigned>(offsetof(sockaddr_un, sun_path) + length);
  socket_ =
      linux_hal::FileDescriptor(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const auto owner = number_in("WATCHDOG_PID");
  const auto time_us = number_in("WATCHDOG_USEC");
  if (time_us && (!owner || *owner == ::getpid())) watchdog_ = std::chrono::microseconds(*time_us);
}

void ServiceManager::alive(hal::Instant now) {
  if (!watchdog_ || now - told_at_ < *watchdog_ / 2) return;
  told_at_ = now;
  send("WATCHDOG=1");
}

void ServiceManager::send(std::string_view words) {
  if (!socket_.valid()) return;
  // Lost words are said again by the next alive(); nothing here may wait for the manager.
  (void)::sendto(socket_.get(), words.data(), words.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                 reinterpret_cast<const sockaddr*>(&address_), address_size_);
}

}  // namespace armsig::daemon
