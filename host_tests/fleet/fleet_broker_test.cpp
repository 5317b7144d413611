// SPDX-License-Identifier: MIT
// What only a real broker shows of an edge node: its will, what is retained, what a session keeps.
// host_tests/fleet/with_broker starts one. Each wait is for a message, and bounded.
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>

#include "firmware/fleet/node/mqtt_transport.hpp"
#include "host_tests/fleet/edge_case.hpp"

namespace armsig::fleet::test {
namespace {

constexpr int kLongest_s = 20;

std::uint64_t steady_ms() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::milliseconds>(
                                        std::chrono::steady_clock::now().time_since_epoch())
                                        .count());
}

BrokerSettings broker_settings() {
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

class FleetBroker : public testing::Test {
 protected:
  void SetUp() override {
    group = "plant" + std::to_string(steady_ms());  // nothing of the tests before
    settings = {.group = group, .node = "arm-1", .host = "host" + group};
    transport = std::make_unique<MqttTransport>(broker_settings(), "arm-" + group);
    node = std::make_unique<EdgeNode>(settings, journal, *transport, 1);
    observer.connection.begin({"none", {}, 0, false});
    until([&] { return observer.up; });
    observer.connection.subscribe("spBv1.0/" + group + "/#", 1);
    host_state(true);
  }
  void TearDown() override {
    observer.publish("spBv1.0/STATE/" + settings.host, {}, true);  // nothing is left retained
    until([&] { return !observer.connection.wants_write(); });
  }

  std::string topic(const std::string& verb) const {
    return "spBv1.0/" + group + "/" + verb + "/arm-1";
  }
  void host_state(bool online) {
    const std::string state = std::string(R"({"online":)") + (online ? "true" : "false") +
                              R"(,"timestamp":)" + std::to_string(++state_ms) + "}";
    observer.publish("spBv1.0/STATE/" + settings.host, std::as_bytes(std::span(state)), true);
  }
  void step() {
    observer.service();
    if (!transport) return;
    const Now now{.steady_ms = steady_ms(), .utc_ms = 1'700'000'000'000 + steady_ms()};
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
  void row(double x) {
    const Reading reading{Item::kResidualX, x};
    const Now now{.steady_ms = steady_ms(), .utc_ms = 1'700'000'000'000 + steady_ms()};
    ASSERT_TRUE(node->record(now, {&reading, 1}));
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

TEST_F(FleetBroker, WillComesWhenTheConnectionBreaksAtQosOneAndNotRetained) {
  until([&] { return observer.count(topic("NBIRTH")) == 1; });
  node.reset();
  transport.reset();  // closes the socket without DISCONNECT
  until([&] { return observer.count(topic("NDEATH")) == 1; });
  const auto& death = observer.last(topic("NDEATH"));
  EXPECT_EQ(death.qos, 1);
  const auto told = decode_report(death.payload);
  const auto born = decode_report(observer.last(topic("NBIRTH")).payload);
  ASSERT_TRUE(told && born);
  EXPECT_EQ(told->bd_seq, born->bd_seq);
  EXPECT_FALSE(told->seq);
}

TEST_F(FleetBroker, NothingOfANodeIsRetained) {
  row(1);
  until([&] { return observer.count(topic("NDATA")) == 1; });
  host_state(false);
  until([&] { return observer.count(topic("NDEATH")) == 1; });
  Client late("late");
  late.connection.begin({"none", {}, 0, false});
  until([&] {
    late.service();
    return late.up;
  });
  late.connection.subscribe("spBv1.0/" + group + "/#", 1);
  late.connection.subscribe("spBv1.0/STATE/" + settings.host, 1);
  // The host's state is, and comes after what else there were.
  until([&] {
    late.service();
    return late.count("spBv1.0/STATE/" + settings.host) > 0;
  });
  EXPECT_TRUE(late.last("spBv1.0/STATE/" + settings.host).retained);
  EXPECT_EQ(late.heard.size(), 1U);
}

TEST_F(FleetBroker, IntendedEndIsToldOnce) {
  until([&] { return observer.count(topic("NBIRTH")) == 1; });
  host_state(false);
  until([&] { return observer.count(topic("NDEATH")) > 0; });
  host_state(true);
  until([&] { return observer.count(topic("NBIRTH")) == 2; });
  EXPECT_EQ(observer.count(topic("NDEATH")), 1U) << "the broker forgot the will";
  const auto again = decode_report(observer.last(topic("NBIRTH")).payload);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->bd_seq, 1U);
  EXPECT_EQ(again->seq, 0U);
}

TEST_F(FleetBroker, RebirthAndAcknowledgementComeAsCommands) {
  row(1);
  until([&] { return observer.count(topic("NDATA")) == 1; });
  EXPECT_EQ(observer.last(topic("NDATA")).qos, 0);
  const Payload acknowledgement = encode_acknowledgement(1, journal.name(), 1);
  observer.publish(topic("NCMD"), {acknowledgement.data(), acknowledgement.size()});
  until([&] { return journal.acknowledged() == 1; });
  const Payload rebirth = encode_rebirth(1);
  observer.publish(topic("NCMD"), {rebirth.data(), rebirth.size()});
  until([&] { return observer.count(topic("NBIRTH")) == 2; });
  EXPECT_EQ(observer.last(topic("NBIRTH")).qos, 0);
  const auto born = decode_report(observer.last(topic("NBIRTH")).payload);
  ASSERT_TRUE(born);
  EXPECT_EQ(born->bd_seq, 0U) << "the same session";
}

TEST_F(FleetBroker, CommandsOfATimeApartAreNotHeardAfterwards) {
  until([&] { return observer.count(topic("NBIRTH")) == 1; });
  host_state(false);
  until([&] { return node->state() == EdgeNode::State::kApart; });
  const Payload rebirth = encode_rebirth(1);
  observer.publish(topic("NCMD"), {rebirth.data(), rebirth.size()});
  until([&] { return observer.count(topic("NCMD")) == 1; });
  host_state(true);
  until([&] { return observer.count(topic("NBIRTH")) == 2; });
  row(1);
  until([&] { return observer.count(topic("NDATA")) == 1; });
  EXPECT_EQ(observer.count(topic("NBIRTH")), 2U) << "a clean session";
}

}  // namespace
}  // namespace armsig::fleet::test
