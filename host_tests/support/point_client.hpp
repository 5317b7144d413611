// SPDX-License-Identifier: MIT
// An instrument's side of the TCP connection on which it tells points.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "hal/linux/file_descriptor.hpp"

namespace armsig::test {

class PointClient {
 public:
  explicit PointClient(std::uint16_t port)
      : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ =
        ::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    // A line is there when say() returns, not when the one before it is acknowledged.
    constexpr int kYes = 1;
    (void)::setsockopt(socket_.get(), IPPROTO_TCP, TCP_NODELAY, &kYes, sizeof kYes);
  }

  [[nodiscard]] bool connected() const { return connected_; }
  // False where the other side has closed the connection.
  bool say(std::string_view text) const {
    return ::send(socket_.get(), text.data(), text.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(text.size());
  }
  // What has arrived, without waiting.
  [[nodiscard]] std::string heard() const {
    std::array<char, 4096> bytes{};
    const ssize_t count = ::recv(socket_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    return count > 0 ? std::string(bytes.data(), static_cast<std::size_t>(count)) : "";
  }
  void close() { socket_.reset(); }

 private:
  linux_hal::FileDescriptor socket_;
  bool connected_ = false;
};

}  // namespace armsig::test
