// SPDX-License-Identifier: MIT
// What only a real broker shows of an edge node: its will, what is retained, what a session keeps.
#include "host_tests/fleet/broker_case.hpp"

namespace armsig::fleet::test {
namespace {

class FleetBroker : public BrokerCase {
 protected:
  void SetUp() override {
    BrokerCase::SetUp();
    start_node();
    host_state(true);
  }
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

// Where the broker lets it through, as this one does.
TEST_F(FleetBroker, MessageThatIsLongerThanAnyOfOursIsNotKept) {
  const std::string other = "spBv1.0/" + group + "/NDATA/arm-9";
  const std::vector<std::byte> longest(MqttConnection::kLongestMessage, std::byte{1});
  const std::vector<std::byte> longer(MqttConnection::kLongestMessage + 1, std::byte{1});
  static_assert(MqttConnection::kLongestMessage >= kLongestPayload);
  observer.publish(other, longer);
  observer.publish(other, std::vector<std::byte>(std::size_t{20} << 20U));
  observer.publish(other, longest);
  until([&] { return observer.count(other) > 0; });
  EXPECT_EQ(observer.count(other), 1U);
  EXPECT_EQ(observer.last(other).payload.size(), longest.size());
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
