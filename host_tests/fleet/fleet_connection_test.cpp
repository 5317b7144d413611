// SPDX-License-Identifier: MIT
// A connection that comes to nothing is told, and not asked about over and over.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "firmware/fleet/wire/mqtt_connection.hpp"

namespace armsig::fleet {
namespace {

// A port of the loopback at which nobody listens.
int closed_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  EXPECT_EQ(::bind(socket, generic, size), 0);
  EXPECT_EQ(::getsockname(socket, generic, &size), 0);
  ::close(socket);
  return ntohs(address.sin_port);
}

// How often it is serviced until it is told that there is no connection.
int services_until_lost(const BrokerSettings& settings) {
  MqttConnection connection(settings, "arm-1");
  connection.begin({"will", {}, 1, false});
  constexpr int kMost = 100;
  for (int i = 0; i < kMost; ++i) {
    for (const MqttConnection::Event& event : connection.take_events()) {
      if (event.kind == MqttConnection::Event::Kind::kLost) return i;
    }
    pollfd ready{.fd = connection.descriptor(), .events = POLLIN, .revents = 0};
    if (connection.wants_write()) ready.events |= POLLOUT;
    (void)::poll(&ready, 1, 100);
    connection.service((ready.revents & (POLLIN | POLLHUP | POLLERR)) != 0,
                       (ready.revents & POLLOUT) != 0);
  }
  return kMost;
}

TEST(FleetConnection, BrokerThatIsNotThereIsToldAtOnce) {
  BrokerSettings settings;
  settings.address = "127.0.0.1";
  settings.port = closed_port();
  EXPECT_LT(services_until_lost(settings), 5);
  settings.authority = "/etc/ssl/certs/ca-certificates.crt";
  EXPECT_LT(services_until_lost(settings), 5) << "with TLS";
}

}  // namespace
}  // namespace armsig::fleet
