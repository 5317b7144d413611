// SPDX-License-Identifier: MIT
// Internet addresses in numbers, of either family: nobody is asked for the meaning of a name.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdint>
#include <optional>
#include <string>

namespace armsig::linux_hal {

// An address with its port.
struct SocketAddress {
  sockaddr_storage storage{};
  socklen_t size = 0;

  [[nodiscard]] const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
};

// Empty: it is none.
[[nodiscard]] std::optional<SocketAddress> address_of(const std::string& told, std::uint16_t port);

// Without its port; one of IPv4 within IPv6 as that of IPv4.
[[nodiscard]] std::string text_of(const sockaddr_storage& storage);

// An address as it is told, in the form in which addresses are compared; empty: it is none.
[[nodiscard]] std::string canonical_address(const std::string& told);
[[nodiscard]] bool is_loopback(const std::string& canonical);

}  // namespace armsig::linux_hal
