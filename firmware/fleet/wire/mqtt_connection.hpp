// SPDX-License-Identifier: MIT
// One connection to a broker by libmosquitto, driven from the caller's own epoll: its loop would
// use select, which ends at 1,024 descriptors.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct mosquitto;

namespace armsig::fleet {

struct BrokerSettings {
  std::string address = "localhost";
  int port = 8883;
  // Files in PEM. All empty: no TLS, which a configuration may ask for on the loopback only.
  std::string authority;
  std::string certificate;
  std::string key;
};

class MqttConnection {
 public:
  // Longer ones that come are dropped; the broker's message_size_limit refuses them before.
  static constexpr std::size_t kLongestMessage = 8192;

  struct Message {
    std::string_view topic;
    std::span<const std::byte> payload;
    int qos = 0;
    bool retain = false;
  };
  struct Event {
    enum class Kind : std::uint8_t { kConnected, kRefused, kLost, kMessage };
    Kind kind = Kind::kLost;
    std::string topic;
    std::vector<std::byte> payload;
    int qos = 0;
    bool retained = false;  // it was there before the subscription
  };

  // `client` is the name that the broker replaces by the certificate's where there is one.
  MqttConnection(BrokerSettings settings, std::string client);
  ~MqttConnection();
  MqttConnection(const MqttConnection&) = delete;
  MqttConnection& operator=(const MqttConnection&) = delete;

  // A clean session of MQTT 3.1.1, anew; what was before is gone without an event. What comes of it
  // is told by events, also where it fails at once.
  void begin(const Message& will);
  void subscribe(const std::string& topic, int qos);
  // False: not connected, or what was published before is still waiting (at QoS 0).
  [[nodiscard]] bool publish(const Message& message);
  // DISCONNECT; waits for at most 0.2 s until it is sent.
  void end();

  // -1: none at present.
  [[nodiscard]] int descriptor() const;
  [[nodiscard]] bool wants_write() const;
  // After epoll, and once a second besides.
  void service(bool readable, bool writable);
  // What has happened since, in its order.
  [[nodiscard]] std::vector<Event> take_events();
  [[nodiscard]] bool has_events() const { return !events_.empty(); }

 private:
  struct Free {
    void operator()(mosquitto* client) const;
  };

  void fail(Event::Kind kind);
  void add_callbacks();

  BrokerSettings settings_;
  std::string client_id_;
  std::unique_ptr<mosquitto, Free> client_;
  std::vector<Event> events_;
};

}  // namespace armsig::fleet
