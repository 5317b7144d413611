// SPDX-License-Identifier: MIT
// What the specification of Sparkplug asserts of an edge node, a test each, on a real broker: by
// what the broker's log says of them, and by the bytes that came.
#include <sys/socket.h>

#include "host_tests/fleet/broker_case.hpp"
#include "host_tests/fleet/protoc.hpp"

namespace armsig::fleet::test {
namespace {

class FleetAssertions : public BrokerCase {
 protected:
  void SetUp() override {
    BrokerCase::SetUp();
    settings.reconnect_ms = 1;
    settings.longest_reconnect_ms = 1;
    settings.rows_per_second = 100'000;
    settings.unacknowledged = 1'000;
  }
  void be_born() {
    start_node();
    host_state(true);
    until([&] { return observer.count(topic("NBIRTH")) == 1; });
  }
  // A message of this node as the broker's log has it, from its name on.
  std::string published(const std::string& verb, int qos) const {
    return "PUBLISH from " + client() + " (d0, q" + std::to_string(qos) + ", r0, m" +
           (qos == 0 ? "0, '" + topic(verb) + "'" : "");
  }
  std::string text_of(const std::string& verb) const {
    return decoded(observer.last(topic(verb)).payload);
  }
  void ask_rebirth() {
    const Payload rebirth = encode_rebirth(1);
    observer.publish(topic("NCMD"), {rebirth.data(), rebirth.size()});
  }
};

TEST_F(FleetAssertions, TopicsAreThoseOfTheNamespace) {
  be_born();
  row(1);
  until([&] { return observer.count(topic("NDATA")) == 1; });
  host_state(false);
  until([&] { return observer.count(topic("NDEATH")) == 1; });
  EXPECT_EQ(topic("NDATA"), "spBv1.0/" + group + "/NDATA/arm-1");
  EXPECT_EQ(times_in_log("PUBLISH from " + client()), 3U) << "and nothing under another";
}

TEST_F(FleetAssertions, SessionIsClean) {
  be_born();
  EXPECT_EQ(times_in_log(" as " + client() + " (p2, c1, "), 1U);
}

TEST_F(FleetAssertions, WillIsItsNDeathAtQosOneNotRetained) {
  be_born();
  const std::string text = log();
  const std::size_t connected = text.find(" as " + client() + " (");
  ASSERT_NE(connected, text.npos);
  const std::size_t will = text.find("Will message specified", connected);
  ASSERT_NE(will, text.npos);
  const std::string told = text.substr(will, text.find("CONNACK", will) - will);
  EXPECT_TRUE(told.contains("(r0, q1)")) << told;
  EXPECT_TRUE(told.contains(topic("NDEATH") + "\n")) << told;
}

TEST_F(FleetAssertions, NDeathIsBdSeqOfInt64AloneAndHasNoSeq) {
  const std::uint64_t before_ms = utc_ms();
  be_born();
  node.reset();
  transport.reset();  // closes the socket without DISCONNECT: the broker tells the will
  until([&] { return observer.count(topic("NDEATH")) == 1; });
  const std::string text = text_of("NDEATH");
  const std::string time = text.substr(0, text.find('\n'));
  // Of when the connection was made, in milliseconds UTC.
  ASSERT_TRUE(time.starts_with("time: ")) << text;
  const std::uint64_t time_ms = std::stoull(time.substr(6));
  EXPECT_GE(time_ms, before_ms) << text;
  EXPECT_LE(time_ms, utc_ms()) << text;
  EXPECT_EQ(text, time + "\nm {\n  name: \"bdSeq\"\n  " + time + "\n  type: 4\n  l: 0\n}\n");
}

// All sessions but one end without a DISCONNECT: what is heard of their end is their will. Between,
// while the host is away, nothing is born.
TEST_F(FleetAssertions, BdSeqBeginsAtNoughtAndRisesWithEveryConnectTo255AndNought) {
  be_born();
  std::size_t ends = 0;
  const auto break_off = [&] {
    ASSERT_EQ(::shutdown(transport->connection().descriptor(), SHUT_RDWR), 0);
    ++ends;
    until([&] { return observer.count(topic("NDEATH")) == ends; });
  };
  break_off();
  until([&] { return observer.count(topic("NBIRTH")) == 2; });
  host_state(false);
  ++ends;
  until([&] { return observer.count(topic("NDEATH")) == ends; });
  while (ends < 255 && !HasFatalFailure()) {
    until([&] { return node->state() == EdgeNode::State::kWaiting; });
    break_off();
  }
  host_state(true);
  for (std::size_t births = observer.count(topic("NBIRTH")); ends < 258 && !HasFatalFailure();) {
    until([&] { return observer.count(topic("NBIRTH")) > births; });
    births = observer.count(topic("NBIRTH"));
    break_off();
  }
  const auto wills = heard("NDEATH");
  ASSERT_EQ(wills.size(), 258U);
  for (std::size_t session = 0; session < wills.size(); ++session) {
    EXPECT_EQ(wills[session].bd_seq, session % 256);
  }
  std::optional<std::uint64_t> born;  // each end after a birth has that birth's number
  for (const auto& message : observer.heard) {
    const auto report = decode_report(message.payload);
    ASSERT_TRUE(report);
    if (message.topic == topic("NBIRTH")) born = report->bd_seq;
    if (message.topic != topic("NDEATH") || !born) continue;
    EXPECT_EQ(born, report->bd_seq);
    born.reset();
  }
  EXPECT_GE(heard("NBIRTH").size(), 5U);
}

TEST_F(FleetAssertions, CommandsAreSubscribedAtQosOneBeforeTheBirth) {
  be_born();
  expect_in_this_order(
      {" as " + client() + " (", client() + " 1 " + topic("NCMD") + "\n", published("NBIRTH", 0)});
}

TEST_F(FleetAssertions, NoBirthUntilTheHostIsOnlineByAStateThatIsNotOlderThanTheLast) {
  const std::uint64_t now_ms = state_ms;
  host_state(false);
  start_node();
  const std::string heard_by_node = "Received PUBACK from " + client();
  until([&] { return times_in_log(heard_by_node) == 1; });
  host_state(true, now_ms - 1'000);
  until([&] { return times_in_log(heard_by_node) == 2; });
  for (int i = 0; i < 20; ++i) step();
  EXPECT_EQ(node->state(), EdgeNode::State::kWaiting);
  EXPECT_EQ(times_in_log("PUBLISH from " + client()), 0U);
  host_state(true);
  until([&] { return observer.count(topic("NBIRTH")) == 1; });
}

TEST_F(FleetAssertions, LeavesWhenTheHostGoesOfflineByNDeathBeforeDisconnect) {
  be_born();
  host_state(false);
  until([&] { return observer.count(topic("NDEATH")) == 1; });
  expect_in_this_order(
      {published("NBIRTH", 0), published("NDEATH", 1), "Received DISCONNECT from " + client()});
}

TEST_F(FleetAssertions, BirthComesFirstAndBirthsAndDataAreAtQosNoughtNotRetained) {
  start_node();
  row(1);
  host_state(true);
  until([&] { return observer.count(topic("NDATA")) == 1; });
  EXPECT_EQ(observer.heard.front().topic, topic("NBIRTH"));
  EXPECT_EQ(times_in_log("PUBLISH from " + client()), 2U);
  EXPECT_EQ(times_in_log(published("NBIRTH", 0)), 1U);
  EXPECT_EQ(times_in_log(published("NDATA", 0)), 1U);
}

TEST_F(FleetAssertions, SeqIsNoughtInTheBirthAndRisesByOneTo255AndNought) {
  be_born();
  for (int i = 0; i < 600; ++i) row(i);
  until([&] { return observer.count(topic("NDATA")) == 600; });
  EXPECT_EQ(heard("NBIRTH").at(0).seq, 0U);
  const auto data = heard("NDATA");
  for (std::size_t i = 0; i < data.size(); ++i) EXPECT_EQ(data[i].seq, (i + 1) % 256);
}

TEST_F(FleetAssertions, BirthNamesEveryMetricWithTypeAliasTimeAndValueOrNull) {
  start_node();
  const Reading mode{Item::kMode, Text("holding")};
  ASSERT_TRUE(node->report({.steady_ms = 1, .utc_ms = 1'700'000'000'000}, {&mode, 1}));
  host_state(true);
  until([&] { return observer.count(topic("NBIRTH")) == 1; });
  const std::string text = text_of("NBIRTH");
  for (const ItemInfo& known : kItems) {
    EXPECT_EQ(count(text, "  name: \"" + std::string(known.name) + "\"\n  alias: "), 1U)
        << known.name;
  }
  const std::size_t metrics = kItems.size() + 2;  // and bdSeq, Rebirth
  EXPECT_EQ(count(text, "m {\n"), metrics);
  EXPECT_EQ(count(text, "  alias: "), kItems.size());
  EXPECT_EQ(count(text, "  time: "), metrics);
  EXPECT_EQ(count(text, "  type: "), metrics);
  EXPECT_EQ(count(text, "  null: true\n"), kItems.size() - 1);
  EXPECT_EQ(count(text, "  s: \"holding\"\n"), 1U);
}

TEST_F(FleetAssertions, DataAreByAliasAloneAndAlwaysHaveTheirTime) {
  be_born();
  row(0.125);
  until([&] { return observer.count(topic("NDATA")) == 1; });
  const std::string text = text_of("NDATA");
  EXPECT_EQ(count(text, "name: "), 0U);
  const std::size_t metrics = count(text, "m {\n");
  EXPECT_GE(metrics, 5U) << "its journal, number, the one before, what was dropped, the reading";
  EXPECT_EQ(count(text, "  alias: "), metrics);
  EXPECT_EQ(count(text, "  time: "), metrics);
  EXPECT_TRUE(text.starts_with("time: ")) << "of the message";
}

TEST_F(FleetAssertions, RebirthIsBooleanWithoutAliasAndBeginsTheSessionAnew) {
  be_born();
  const std::string text = text_of("NBIRTH");
  const std::size_t at = text.find("  name: \"Node Control/Rebirth\"\n");
  ASSERT_NE(at, text.npos);
  const std::string metric = text.substr(at, text.find('}', at) - at);
  EXPECT_TRUE(metric.ends_with("  type: 11\n  b: false\n")) << metric;
  EXPECT_FALSE(metric.contains("alias")) << metric;
  for (int i = 0; i < 300; ++i) row(i);
  ask_rebirth();
  until([&] { return observer.count(topic("NBIRTH")) == 2; });
  until([&] {
    const auto data = heard("NDATA");
    return !data.empty() && data.back().integer(Item::kNumber) == 300;
  });
  EXPECT_EQ(heard("NBIRTH")[1].bd_seq, heard("NBIRTH")[0].bd_seq);
  EXPECT_EQ(heard("NBIRTH")[1].readings.size(), kItems.size()) << "whole";
  EXPECT_EQ(times_in_log(" as " + client() + " ("), 1U) << "no new connection";
  std::uint64_t expected = 0;  // data of before stop at the birth, and begin after it at 1
  for (const auto& message : observer.heard) {
    if (message.topic == topic("NCMD")) continue;
    if (message.topic == topic("NBIRTH")) expected = 0;
    const auto report = decode_report(message.payload);
    ASSERT_TRUE(report);
    EXPECT_EQ(report->seq, expected);
    expected = (expected + 1) % 256;
  }
}

TEST_F(FleetAssertions, PresentValuesAreInTheOrderOfTime) {
  be_born();
  constexpr std::int64_t kDay_ms = 86'400'000;
  for (const std::int64_t later_ms : {std::int64_t{0}, -kDay_ms, 2 * kDay_ms, kDay_ms}) {
    row(1, later_ms);
  }
  until([&] { return observer.count(topic("NDATA")) == 4; });
  std::uint64_t before_ms = 0;
  std::vector<bool> historical;
  for (const Report& report : heard("NDATA")) {
    historical.push_back(report.historical);
    if (report.historical) continue;
    EXPECT_GE(report.time_ms, before_ms);
    before_ms = report.time_ms;
  }
  EXPECT_EQ(historical, (std::vector{false, true, false, true}));
}

TEST_F(FleetAssertions, OnlyWhatChangedIsReported) {
  be_born();
  for (const double air_c : {20.5, 20.5, 20.5, 21.0}) {
    const std::array<Reading, 2> readings{Reading{Item::kMode, Text("idle")},
                                          Reading{Item::kAir, air_c}};
    ASSERT_TRUE(node->report({.steady_ms = 1, .utc_ms = 1'800'000'000'000}, readings));
  }
  until([&] { return observer.count(topic("NDATA")) == 2; });
  row(1);  // what comes after it shows that there was no more
  until([&] { return observer.count(topic("NDATA")) == 3; });
  const auto data = heard("NDATA");
  EXPECT_EQ(data[1].find(Item::kMode), nullptr);
  EXPECT_EQ(*data[1].find(Item::kAir), Value(21.0));
  EXPECT_NE(data[2].find(Item::kResidualX), nullptr);
}

}  // namespace
}  // namespace armsig::fleet::test
