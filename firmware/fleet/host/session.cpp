// SPDX-License-Identifier: MIT
#include "firmware/fleet/host/session.hpp"

#include <algorithm>
#include <utility>

namespace armsig::fleet {
namespace {

constexpr std::uint64_t kRetry_ms = 1'000;
constexpr std::uint64_t kSendEvery_ms = 50;

std::string state_text(bool online, std::uint64_t time_ms) {
  return std::string(R"({"online":)") + (online ? "true" : "false") + R"(,"timestamp":)" +
         std::to_string(time_ms) + "}";
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

// The record takes no other names, and no cabinet that is configured has one.
bool is_name(std::string_view name) {
  return !name.empty() && name.size() <= 64 && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.';
  });
}

}  // namespace

HostSession::HostSession(BrokerSettings broker, std::string group, std::string host)
    : connection_(std::move(broker), host),
      root_("spBv1.0/" + std::move(group) + "/"),
      state_topic_("spBv1.0/STATE/" + std::move(host)) {}

void HostSession::begin(std::uint64_t steady_ms, std::uint64_t utc_ms) {
  connected_ = false;
  due_ms_ = steady_ms + 10 * kRetry_ms;  // to be connected
  time_ms_ = std::max(utc_ms, time_ms_ + 1);
  const std::string will = state_text(false, time_ms_);
  connection_.begin({state_topic_, bytes_of(will), 1, true});
}

void HostSession::tell_state(bool online) {
  const std::string text = state_text(online, time_ms_);
  (void)connection_.publish({state_topic_, bytes_of(text), 1, true});
}

void HostSession::end() {
  if (connected_) tell_state(false);
  connection_.end();
}

void HostSession::step(std::uint64_t steady_ms, std::uint64_t utc_ms, Intake& intake) {
  if (!connected_ && steady_ms >= due_ms_) begin(steady_ms, utc_ms);
  for (const MqttConnection::Event& event : connection_.take_events()) {
    take(event, steady_ms, intake);
  }
  // Looks at every arm: not once a message.
  if (connected_ && steady_ms - sent_ms_ >= kSendEvery_ms) {
    sent_ms_ = steady_ms;
    send(steady_ms, utc_ms, intake);
  }
}

void HostSession::take(const MqttConnection::Event& event, std::uint64_t steady_ms,
                       Intake& intake) {
  using Kind = MqttConnection::Event::Kind;
  switch (event.kind) {
    case Kind::kConnected:
      connected_ = true;
      connection_.subscribe(state_topic_, 1);
      connection_.subscribe(root_ + "#", 1);
      tell_state(true);
      return;
    case Kind::kRefused:
    case Kind::kLost:
      connected_ = false;
      due_ms_ = steady_ms + kRetry_ms;
      return;
    case Kind::kMessage:
      break;
  }
  if (event.topic == state_topic_) {
    take_state(event.payload, steady_ms);
  } else {
    take_message(event, intake);
  }
}

void HostSession::take_state(std::span<const std::byte> payload, std::uint64_t steady_ms) {
  const auto state = decode_state(payload);
  if (!state || !connected_) return;
  // Left by a session whose clock was ahead: begin again, later than it.
  if (state->timestamp_ms > time_ms_) {
    time_ms_ = state->timestamp_ms;
    connection_.end();
    connected_ = false;
    due_ms_ = steady_ms;
  } else if (!state->online) {
    tell_state(true);
  }
}

void HostSession::take_message(const MqttConnection::Event& event, Intake& intake) {
  std::string_view topic = event.topic;
  if (!topic.starts_with(root_)) return;
  topic.remove_prefix(root_.size());
  const std::size_t slash = topic.find('/');
  if (slash == std::string_view::npos) return;
  const std::string_view verb = topic.substr(0, slash);
  const std::string_view node = topic.substr(slash + 1);
  if (!is_name(node)) return;
  if (verb == "NBIRTH") intake.birth(node, event.payload);
  if (verb == "NDATA") intake.data(node, event.payload);
  if (verb == "NDEATH") intake.death(node, event.payload);
}

void HostSession::send(std::uint64_t steady_ms, std::uint64_t utc_ms, Intake& intake) {
  const auto command = [&](const std::string& node, const Payload& payload) {
    (void)connection_.publish({root_ + "NCMD/" + node, {payload.data(), payload.size()}, 1, false});
  };
  for (const auto& told : intake.acknowledgements(steady_ms)) {
    command(told.node, encode_acknowledgement(utc_ms, told.journal, told.number));
  }
  for (const std::string& node : intake.rebirths(steady_ms)) {
    command(node, encode_rebirth(utc_ms));
  }
}

}  // namespace armsig::fleet
