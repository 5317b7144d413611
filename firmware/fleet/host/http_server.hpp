// SPDX-License-Identifier: MIT
// HTTP for a few readers on the loopback: GET, one request a connection. Bounded: 64 connections
// that have not sent their request, 16 that read a reply, requests of 4 KiB, five seconds. Where a
// new one has no place the oldest of its kind goes: who is slow keeps nobody out who is not. A
// request for another name than the loopback's or one that was configured is refused: a page
// elsewhere can have a browser ask by a name that it lets mean 127.0.0.1.
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

  // `names` are those by which it is asked beside the loopback's, by a proxy. Port 0: any. None:
  // the port is taken.
  [[nodiscard]] static std::optional<HttpServer> open(int port,
                                                      std::vector<std::string> names = {});
  [[nodiscard]] int port() const;

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

  HttpServer(linux_hal::FileDescriptor listener, std::vector<std::string> names)
      : listener_(std::move(listener)), names_(std::move(names)) {}
  void advance(Client& client, const Respond& respond) const;
  void accept_all(std::uint64_t steady_ms);
  void drop_oldest();
  [[nodiscard]] bool is_ours(std::string_view request) const;
  [[nodiscard]] std::string reply_to(std::string_view request, const Respond& respond) const;

  linux_hal::FileDescriptor listener_;
  std::vector<std::string> names_;
  std::vector<Client> clients_;  // the oldest first
};

}  // namespace armsig::fleet
