// SPDX-License-Identifier: MIT
#include "hal/linux/internet_address.hpp"

#include <arpa/inet.h>

#include <array>
#include <cstring>
#include <string_view>

namespace armsig::linux_hal {

std::optional<SocketAddress> address_of(const std::string& told, std::uint16_t port) {
  SocketAddress address;
  sockaddr_in v4{};
  sockaddr_in6 v6{};
  if (::inet_pton(AF_INET, told.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    v4.sin_port = htons(port);
    std::memcpy(&address.storage, &v4, sizeof v4);
    address.size = sizeof v4;
    return address;
  }
  if (::inet_pton(AF_INET6, told.c_str(), &v6.sin6_addr) != 1) return std::nullopt;
  v6.sin6_family = AF_INET6;
  v6.sin6_port = htons(port);
  std::memcpy(&address.storage, &v6, sizeof v6);
  address.size = sizeof v6;
  return address;
}

std::string text_of(const sockaddr_storage& storage) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (storage.ss_family == AF_INET) {
    sockaddr_in v4{};
    std::memcpy(&v4, &storage, sizeof v4);
    ::inet_ntop(AF_INET, &v4.sin_addr, text.data(), text.size());
  } else if (storage.ss_family == AF_INET6) {
    sockaddr_in6 v6{};
    std::memcpy(&v6, &storage, sizeof v6);
    ::inet_ntop(AF_INET6, &v6.sin6_addr, text.data(), text.size());
  }
  constexpr std::string_view kMapped = "::ffff:";
  const std::string whole(text.data());
  const bool mapped = whole.starts_with(kMapped) && whole.contains('.');
  return mapped ? whole.substr(kMapped.size()) : whole;
}

std::string canonical_address(const std::string& told) {
  const auto address = address_of(told, 0);
  return address ? text_of(address->storage) : std::string();
}

bool is_loopback(const std::string& canonical) {
  return canonical == "::1" || canonical.starts_with("127.");
}

}  // namespace armsig::linux_hal
