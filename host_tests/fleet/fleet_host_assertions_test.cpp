// SPDX-License-Identifier: MIT
// What the specification of Sparkplug asserts of a host application, a test each, on a real broker.
#include "firmware/fleet/host/session.hpp"
#include "host_tests/fleet/broker_case.hpp"

namespace armsig::fleet::test {
namespace {

class FleetHostAssertions : public BrokerCase {
 protected:
  void SetUp() override {
    BrokerCase::SetUp();
    observer.connection.subscribe(state_topic(), 1);
    session = std::make_unique<HostSession>(broker_settings(), group, settings.host);
    intake.begin({});
  }
  void until_host(const std::function<bool()>& condition) {
    until([&] {
      if (session) {
        MqttConnection& connection = session->connection();
        pollfd ready{.fd = connection.descriptor(), .events = POLLIN, .revents = 0};
        (void)::poll(&ready, 1, 2);
        connection.service(ready.revents != 0, connection.wants_write());
        session->step(steady_ms(), 1'700'000'000'000, intake);
      }
      return condition();
    });
  }
  std::string told() const {
    const auto& payload = observer.last(state_topic()).payload;
    return {reinterpret_cast<const char*>(payload.data()), payload.size()};
  }

  Intake intake;
  std::unique_ptr<HostSession> session;
};

TEST_F(FleetHostAssertions, StateIsRetainedAtQosOneAndItsWillSaysOffline) {
  until_host([&] { return observer.count(state_topic()) > 0; });
  EXPECT_EQ(told(), R"({"online":true,"timestamp":1700000000000})");
  const std::string text = log();
  const std::size_t connected = text.find(" as " + settings.host + " (");
  ASSERT_NE(connected, text.npos);
  const std::size_t will = text.find("Will message specified", connected);
  ASSERT_NE(will, text.npos);
  const std::string specified = text.substr(will, text.find("CONNACK", will) - will);
  EXPECT_TRUE(specified.contains("(r1, q1)")) << specified;
  EXPECT_TRUE(specified.contains(state_topic() + "\n")) << specified;
  EXPECT_TRUE(text.contains("PUBLISH from " + settings.host + " (d0, q1, r1, m"));
  const std::size_t before = observer.count(state_topic());
  session.reset();  // closes the socket without DISCONNECT
  until_host([&] { return observer.count(state_topic()) > before; });
  EXPECT_EQ(told(), R"({"online":false,"timestamp":1700000000000})") << "the time of its birth";
}

TEST_F(FleetHostAssertions, GapInSeqIsAnsweredByARebirthRequest) {
  until_host([&] { return observer.count(state_topic()) > 0; });
  const auto tell = [&](const char* verb, const Payload& payload) {
    observer.publish(topic(verb), {payload.data(), payload.size()});
  };
  RowMessage message{.journal = 7,
                     .number = 1,
                     .previous = 0,
                     .dropped = 0,
                     .time_ms = 5,
                     .historical = false,
                     .readings = {}};
  tell("NBIRTH", encode_birth(1, 0, {}));
  tell("NDATA", encode_row(9, 1, message));
  until_host([&] { return intake.waiting().rows.size() == 1; });
  const auto asked = [&] {
    return std::ranges::count_if(observer.heard, [&](const auto& told) {
      if (told.topic != topic("NCMD")) return false;
      const auto command = decode_command(told.payload);
      return command && command->rebirth && told.qos == 1;
    });
  };
  EXPECT_EQ(asked(), 0) << "without a gap nothing is asked for";
  message.number = 2;
  message.previous = 1;
  tell("NDATA", encode_row(9, 3, message));
  until_host([&] { return asked() == 1; });
}

}  // namespace
}  // namespace armsig::fleet::test
