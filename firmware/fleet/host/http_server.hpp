// SPDX-License-Identifier: MIT
// HTTP for a few readers on the loopback: GET, one request a connection. Bounded: 16 connections,
// requests of 4 KiB, five seconds.
#pragma once

#include <poll.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/fleet/host/page.hpp"
#include "hal/linux/file_descriptor.hpp"

namespace armsig::fleet {

class HttpServer {
 public:
  using Respond = std::function<Answer(std::string_view path)>;

  // None: the port is taken.
  [[nodiscard]] static std::optional<HttpServer> open(int port);

  void add_to(std::vector<pollfd>& ready) const;
  // After poll, with the entries that add_to() added.
  void service(const pollfd* ready, std::uint64_t steady_ms, const Respond& respond);

 private:
  struct Client {
    linux_hal::FileDescriptor socket;
    std::string request;
    std::string reply;  // what is left of it
    std::uint64_t since_ms = 0;
  };

  explicit HttpServer(linux_hal::FileDescriptor listener) : listener_(std::move(listener)) {}
  static void advance(Client& client, const Respond& respond);

  linux_hal::FileDescriptor listener_;
  std::vector<Client> clients_;
};

}  // namespace armsig::fleet
