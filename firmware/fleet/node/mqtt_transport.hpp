// SPDX-License-Identifier: MIT
// The transport of an edge node over libmosquitto.
#pragma once

#include <string>
#include <utility>

#include "firmware/fleet/node/edge_node.hpp"
#include "firmware/fleet/node/transport.hpp"
#include "firmware/fleet/wire/mqtt_connection.hpp"

namespace armsig::fleet {

class MqttTransport final : public Transport {
 public:
  MqttTransport(BrokerSettings settings, std::string client)
      : connection_(std::move(settings), std::move(client)) {}

  [[nodiscard]] MqttConnection& connection() { return connection_; }

  // Hands on what has happened.
  void deliver(EdgeNode& node, const Now& now) {
    using Kind = MqttConnection::Event::Kind;
    for (const MqttConnection::Event& event : connection_.take_events()) {
      if (event.kind == Kind::kMessage) {
        node.message(now, event.topic, event.payload);
      } else if (event.kind == Kind::kLost) {
        node.lost(now);
      } else {
        node.connected(now, event.kind == Kind::kConnected);
      }
    }
  }

 private:
  void do_connect(const Will& will) override {
    connection_.begin({will.topic, will.payload, 1, false});
  }
  void do_subscribe(std::string_view topic, int qos) override {
    connection_.subscribe(std::string(topic), qos);
  }
  bool do_publish(std::string_view topic, std::span<const std::byte> payload, int qos) override {
    return connection_.publish({topic, payload, qos, false});
  }
  void do_disconnect() override { connection_.end(); }

  MqttConnection connection_;
};

}  // namespace armsig::fleet
