// SPDX-License-Identifier: MIT
// What an edge node needs of MQTT, and nothing of who provides it. Events come back by the methods
// of EdgeNode, never from within these calls.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace armsig::fleet {

class Transport {
 public:
  struct Will {
    std::string_view topic;
    std::span<const std::byte> payload;  // at QoS 1, not retained
  };

  // Begins a clean session.
  void connect(const Will& will) { do_connect(will); }
  void subscribe(std::string_view topic, int qos) { do_subscribe(topic, qos); }
  // False: the connection takes nothing at present, and the message is not sent.
  [[nodiscard]] bool publish(std::string_view topic, std::span<const std::byte> payload, int qos) {
    return do_publish(topic, payload, qos);
  }
  // An intended end: the broker forgets the will. A session that is only being made is given up.
  void disconnect() { do_disconnect(); }

 protected:
  ~Transport() = default;

 private:
  virtual void do_connect(const Will& will) = 0;
  virtual void do_subscribe(std::string_view topic, int qos) = 0;
  virtual bool do_publish(std::string_view topic, std::span<const std::byte> payload, int qos) = 0;
  virtual void do_disconnect() = 0;
};

}  // namespace armsig::fleet
