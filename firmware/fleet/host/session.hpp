// SPDX-License-Identifier: MIT
// The host's own session with the broker: its state, which is its will, and the messages of all
// cabinets of its group.
#pragma once

#include <string>

#include "firmware/fleet/host/intake.hpp"
#include "firmware/fleet/wire/mqtt_connection.hpp"

namespace armsig::fleet {

class HostSession {
 public:
  HostSession(BrokerSettings broker, std::string group, std::string host);

  // Connects where it is time to, takes what has come, sends what `intake` has to say.
  void step(std::uint64_t steady_ms, std::uint64_t utc_ms, Intake& intake);
  // Tells that it goes, and goes.
  void end();

  [[nodiscard]] MqttConnection& connection() { return connection_; }

 private:
  void begin(std::uint64_t steady_ms, std::uint64_t utc_ms);
  void tell_state(bool online);
  void take(const MqttConnection::Event& event, std::uint64_t steady_ms, Intake& intake);
  // Of a session of this host: our own, or one before it.
  void take_state(std::span<const std::byte> payload, std::uint64_t steady_ms);
  void take_message(const MqttConnection::Event& event, Intake& intake);
  void send(std::uint64_t steady_ms, std::uint64_t utc_ms, Intake& intake);

  MqttConnection connection_;
  std::string root_;  // "spBv1.0/GROUP/"
  std::string state_topic_;
  bool connected_ = false;
  std::uint64_t due_ms_ = 0;
  std::uint64_t sent_ms_ = 0;  // when commands were last looked for
  // Of the session; above that of every state that was ever there, whatever the clock says.
  std::uint64_t time_ms_ = 0;
};

}  // namespace armsig::fleet
