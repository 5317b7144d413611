// SPDX-License-Identifier: MIT
// An edge node, and a client that hears everything of its plant, on a real broker:
// host_tests/fleet/with_broker starts one. Each wait is for a message, and bounded.
#pragma once

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>

#include "firmware/fleet/node/mqtt_transport.hpp"
#include "host_tests/fleet/edge_case.hpp"

namespace armsig::fleet::test {

inline constexpr int kLongest_s = 20;

inline std::uint64_t steady_ms() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::milliseconds>(
                                        std::chrono::steady_clock::now().time_since_epoch())
                                        .count());
}

// What the nodes of these tests are told of the calendar.
inline std::uint64_t utc_ms() { return 1'700'000'000'000 + steady_ms(); }

inline BrokerSettings broker_settings() {
  const char* port = std::getenv("ARMSIG_BROKER_PORT");
  EXPECT_NE(port, nullptr) << "run by host_tests/fleet/with_broker";
  BrokerSettings settings;
  settings.address = "127.0.0.1";
  settings.port = port != nullptr ? std::atoi(port) : 1;
  return settings;
}

// Another client, which hears everything of the plant.
struct Client {
  explicit Client(const std::string& name) : connection(broker_settings(), name) {}

  void service() {
    pollfd ready{.fd = connection.descriptor(), .events = POLLIN, .revents = 0};
    if (connection.wants_write()) ready.events |= POLLOUT;
    (void)::poll(&ready, 1, 2);
    connection.service((ready.revents & ~POLLOUT) != 0, (ready.revents & POLLOUT) != 0);
    for (auto& event : connection.take_events()) {
      up = up || event.kind == MqttConnection::Event::Kind::kConnected;
      if (event.kind == MqttConnection::Event::Kind::kMessage) heard.push_back(std::move(event));
    }
  }
  void publish(const std::string& topic, std::span<const std::byte> payload, bool retain = false) {
    EXPECT_TRUE(connection.publish({topic, payload, 1, retain}));
  }
  std::size_t count(const std::string& topic) const {
    return static_cast<std::size_t>(
        std::ranges::count(heard, topic, &MqttConnection::Event::topic));
  }
  const MqttConnection::Event& last(const std::string& topic) const {
    for (std::size_t i = heard.size(); i > 0; --i) {
      if (heard[i - 1].topic == topic) return heard[i - 1];
    }
    ADD_FAILURE() << "nothing heard of " << topic;
    return none;
  }

  MqttConnection connection;
  bool up = false;
  std::vector<MqttConnection::Event> heard;
  MqttConnection::Event none;
};

class BrokerCase : public testing::Test {
 protected:
  void SetUp() override {
    group = "plant" + std::to_string(steady_ms());  // nothing of the tests before
    settings = {.group = group, .node = "arm-1", .host = "host" + group};
    observer.connection.begin({"none", {}, 0, false});
    until([&] { return observer.up; });
    observer.connection.subscribe("spBv1.0/" + group + "/#", 1);
  }
  void start_node() {
    transport = std::make_unique<MqttTransport>(broker_settings(), client());
    node = std::make_unique<EdgeNode>(settings, journal, *transport, 1);
  }
  void TearDown() override {
    observer.publish(state_topic(), {}, true);  // nothing is left retained
    until([&] { return !observer.connection.wants_write(); });
  }

  std::string client() const { return "arm-" + group; }
  std::string state_topic() const { return "spBv1.0/STATE/" + settings.host; }
  std::string topic(const std::string& verb) const {
    return "spBv1.0/" + group + "/" + verb + "/arm-1";
  }
  void host_state(bool online) { host_state(online, ++state_ms); }
  void host_state(bool online, std::uint64_t timestamp_ms) {
    const std::string state = std::string(R"({"online":)") + (online ? "true" : "false") +
                              R"(,"timestamp":)" + std::to_string(timestamp_ms) + "}";
    observer.publish(state_topic(), std::as_bytes(std::span(state)), true);
  }
  void step() {
    observer.service();
    if (!transport) return;
    const Now now{.steady_ms = steady_ms(), .utc_ms = utc_ms()};
    MqttConnection& connection = transport->connection();
    pollfd ready{.fd = connection.descriptor(), .events = POLLIN, .revents = 0};
    if (connection.wants_write()) ready.events |= POLLOUT;
    (void)::poll(&ready, 1, 2);
    connection.service((ready.revents & ~POLLOUT) != 0, (ready.revents & POLLOUT) != 0);
    transport->deliver(*node, now);
    node->tick(now);
  }
  void until(const std::function<bool()>& condition) {
    const std::uint64_t end = steady_ms() + 1'000 * kLongest_s;
    while (!condition() && steady_ms() < end) step();
    ASSERT_TRUE(condition());
  }
  void row(double x, std::int64_t later_ms = 0) {
    const Reading reading{Item::kResidualX, x};
    const Now now{.steady_ms = steady_ms(),
                  .utc_ms = utc_ms() + static_cast<std::uint64_t>(later_ms)};
    ASSERT_TRUE(node->record(now, {&reading, 1}));
  }
  std::vector<Report> heard(const std::string& verb) const {
    std::vector<Report> reports;
    for (const auto& message : observer.heard) {
      if (message.topic != topic(verb)) continue;
      const auto report = decode_report(message.payload);
      EXPECT_TRUE(report);
      if (report) reports.push_back(*report);
    }
    return reports;
  }
  // What the broker itself has written about who did what.
  static std::string log() {
    const char* path = std::getenv("ARMSIG_BROKER_LOG");
    EXPECT_NE(path, nullptr) << "run by host_tests/fleet/with_broker";
    std::ostringstream text;
    if (path != nullptr) text << std::ifstream(path).rdbuf();
    return text.str();
  }
  static std::size_t times_in_log(const std::string& words) {
    const std::string text = log();
    std::size_t times = 0;
    for (std::size_t at = text.find(words); at != text.npos; at = text.find(words, at + 1)) ++times;
    return times;
  }
  void expect_in_this_order(const std::vector<std::string>& words) {
    until([&] { return log().contains(words.back()); });
    const std::string text = log();
    std::size_t at = 0;
    for (const std::string& each : words) {
      at = text.find(each, at);
      ASSERT_NE(at, text.npos) << "not there, or too early: " << each;
    }
  }

  std::string group;
  EdgeSettings settings;
  RamStorage storage;
  Journal journal = *Journal::open(storage, 1024, 7);
  std::unique_ptr<MqttTransport> transport;
  std::unique_ptr<EdgeNode> node;
  Client observer{"observer"};
  std::uint64_t state_ms = 1'700'000'000'000;
};

}  // namespace armsig::fleet::test
