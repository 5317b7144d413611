// SPDX-License-Identifier: MIT
// What the specification of Sparkplug asks of an edge node, a test each, and what this product
// promises beyond it.
#include "host_tests/fleet/edge_case.hpp"

namespace armsig::fleet::test {
namespace {

using Numbers = std::vector<std::uint64_t>;
using State = EdgeNode::State;

class FleetEdge : public EdgeCase {};

TEST_F(FleetEdge, WillIsNDeathAtQosOneWithBdSeqAndWithoutSeq) {
  node.tick(now);
  ASSERT_EQ(broker.wills.size(), 1U);
  EXPECT_EQ(broker.wills[0].topic, kDeath);
  const auto will = decode_report(broker.wills[0].payload);
  ASSERT_TRUE(will);
  EXPECT_EQ(will->bd_seq, 0U);
  EXPECT_FALSE(will->seq);
  EXPECT_TRUE(will->readings.empty());
}

TEST_F(FleetEdge, BdSeqRisesWithEveryConnectAndReturnsToZeroAfter255) {
  for (std::uint64_t session = 0; session <= 257; ++session) {
    be_born();
    const auto will = decode_report(broker.wills.back().payload);
    ASSERT_TRUE(will);
    EXPECT_EQ(will->bd_seq, session % 256);
    EXPECT_EQ(sent(kBirth).back().bd_seq, session % 256) << "the same in NBIRTH";
    node.lost(now);
  }
}

TEST_F(FleetEdge, CommandsAndHostAreSubscribedAtQosOneBeforeTheBirth) {
  be_born();
  const std::vector<std::string> expected{"connect", "subscribe " + std::string(kCommand) + " at 1",
                                          "subscribe " + std::string(kState) + " at 1", kBirth};
  EXPECT_EQ(broker.calls, expected);
}

TEST_F(FleetEdge, NoBirthUntilTheHostIsOnline) {
  connect();
  row(1);
  wait_long(60);
  EXPECT_TRUE(broker.published.empty());
  offline();
  host("{}");
  host("online");
  EXPECT_TRUE(broker.published.empty());
  online();
  EXPECT_EQ(sent(kBirth).size(), 1U);
}

TEST_F(FleetEdge, HostStateOlderThanTheLastIsIgnored) {
  connect();
  offline();
  host(R"({"online":true,"timestamp":1000})");
  EXPECT_EQ(node.state(), State::kWaiting);
  online();
  EXPECT_EQ(node.state(), State::kBorn);
  host(R"({"timestamp" : 1000, "online" : false})");
  EXPECT_EQ(node.state(), State::kBorn);
}

TEST_F(FleetEdge, LeavesWithNDeathBeforeDisconnectWhenTheHostGoesOffline) {
  be_born();
  broker.calls.clear();
  offline();
  EXPECT_EQ(broker.calls, (std::vector<std::string>{kDeath, "disconnect"}));
  EXPECT_EQ(broker.published.back().qos, 1);
  EXPECT_EQ(sent(kDeath).back().bd_seq, 0U);
  EXPECT_FALSE(sent(kDeath).back().seq);
  connect();
  EXPECT_EQ(node.state(), State::kWaiting) << "back, and waiting for the host";
}

TEST_F(FleetEdge, BirthNamesEveryMetricWithValueOrNullAndSeqZero) {
  const Reading mode{Item::kMode, Text("holding")};
  ASSERT_TRUE(node.report(now, {&mode, 1}));
  be_born();
  const Report birth = sent(kBirth).at(0);
  EXPECT_EQ(birth.seq, 0U);
  EXPECT_EQ(birth.readings.size(), kItems.size());
  for (const ItemInfo& known : kItems) ASSERT_NE(birth.find(known.item), nullptr) << known.name;
  EXPECT_EQ(*birth.find(Item::kMode), Value(Text("holding")));
  EXPECT_EQ(*birth.find(Item::kFault), Value());
  EXPECT_EQ(broker.published[0].qos, 0);
}

TEST_F(FleetEdge, SeqRisesByOneAndReturnsToZeroAfter255) {
  be_born();
  for (int i = 0; i < 600; ++i) {
    row(i);
    wait(100);
    acknowledge(journal.last());
  }
  const auto data = sent(kData);
  ASSERT_EQ(data.size(), 600U);
  for (std::size_t i = 0; i < data.size(); ++i) EXPECT_EQ(data[i].seq, (i + 1) % 256);
}

TEST_F(FleetEdge, DataAreAtQosZeroAndByAliasOnly) {
  be_born();
  row(0.125);
  wait(100);
  ASSERT_EQ(broker.published.size(), 2U);
  EXPECT_EQ(broker.published[1].topic, kData);
  EXPECT_EQ(broker.published[1].qos, 0);
  const std::string text(reinterpret_cast<const char*>(broker.published[1].payload.data()),
                         broker.published[1].payload.size());
  for (const ItemInfo& known : kItems) EXPECT_EQ(text.find(known.name), std::string::npos);
  EXPECT_EQ(*sent(kData).at(0).find(Item::kResidualX), Value(0.125));
}

TEST_F(FleetEdge, RebirthIsAWholeBirthOfTheSameSession) {
  be_born();
  row(1);
  wait(100);
  ask_rebirth();
  ASSERT_EQ(sent(kBirth).size(), 2U);
  EXPECT_EQ(sent(kBirth)[1].seq, 0U);
  EXPECT_EQ(sent(kBirth)[1].bd_seq, 0U);
  EXPECT_EQ(sent(kBirth)[1].readings.size(), kItems.size());
  wait(100);
  EXPECT_EQ(numbers_sent(), (Numbers{1, 1})) << "and the row that nobody acknowledged again";
  EXPECT_EQ(sent(kData).back().seq, 1U);
  EXPECT_TRUE(sent(kData).back().historical);
}

TEST_F(FleetEdge, OnlyItsOwnCommandsAreHeard) {
  be_born();
  const Payload rebirth = encode_rebirth(now.utc_ms);
  tell("spBv1.0/plant/NCMD/arm-2", {rebirth.data(), rebirth.size()});
  const std::string noise = "\x0a\xff\xff\xff";
  tell(kCommand, std::as_bytes(std::span(noise)));
  EXPECT_EQ(sent(kBirth).size(), 1U);
}

TEST_F(FleetEdge, PresentValuesAreInTheOrderOfTimeWhateverTheClockDoes) {
  be_born();
  row(1);
  wait(100);
  now.utc_ms -= 86'400'000;  // set back by a day
  row(2);
  wait(100);
  now.utc_ms += 2 * 86'400'000ULL;
  row(3);
  wait(100);
  const auto data = sent(kData);
  ASSERT_EQ(data.size(), 3U);
  EXPECT_FALSE(data[0].historical);
  EXPECT_TRUE(data[1].historical);
  EXPECT_FALSE(data[2].historical);
  EXPECT_LT(data[1].time_ms, data[0].time_ms) << "the time is told as it was";
}

TEST_F(FleetEdge, OnlyWhatChangedIsReported) {
  be_born();
  const std::array<Reading, 2> readings{Reading{Item::kMode, Text("idle")},
                                        Reading{Item::kAir, 20.5}};
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(node.report(now, readings));
  wait(100);
  EXPECT_EQ(numbers_sent(), Numbers{1});
  const std::array<Reading, 2> warmer{readings[0], Reading{Item::kAir, 21.0}};
  ASSERT_TRUE(node.report(now, warmer));
  wait(100);
  ASSERT_EQ(sent(kData).size(), 2U);
  EXPECT_EQ(sent(kData)[1].find(Item::kMode), nullptr);
  EXPECT_EQ(*sent(kData)[1].find(Item::kAir), Value(21.0));
}

TEST_F(FleetEdge, RowsWrittenApartAreSentAsHistoryAfterTheBirth) {
  for (int i = 0; i < 5; ++i) row(i);
  be_born();
  wait(1'000);
  EXPECT_EQ(numbers_sent(), (Numbers{1, 2, 3, 4, 5}));
  for (const Report& report : sent(kData)) EXPECT_TRUE(report.historical);
  std::uint64_t before = 0;
  for (const Report& report : sent(kData)) {
    EXPECT_EQ(report.integer(Item::kPrevious), before);
    EXPECT_EQ(report.integer(Item::kJournal), kName);
    before = report.integer(Item::kNumber).value_or(0);
  }
}

TEST_F(FleetEdge, UnansweredRowsAreSentAgainLessAndLessOften) {
  be_born();
  row(1);
  wait_long(60);
  EXPECT_EQ(numbers_sent().size(), 4U) << "at once, and after 5, 15 and 35 s";
  acknowledge(1);
  wait_long(600);
  EXPECT_EQ(numbers_sent().size(), 4U);
}

TEST_F(FleetEdge, AcknowledgementOfAnotherJournalOrOfTheFutureIsIgnored) {
  be_born();
  row(1);
  wait(100);
  acknowledge(1, kName + 1);
  acknowledge(2);
  EXPECT_EQ(journal.acknowledged(), 0U);
  acknowledge(1);
  EXPECT_EQ(journal.acknowledged(), 1U);
}

TEST_F(FleetEdge, HostThatWentBackGetsTheRowsAgain) {
  be_born();
  for (int i = 0; i < 5; ++i) row(i);
  wait(1'000);
  acknowledge(5);
  acknowledge(2);
  wait(1'000);
  EXPECT_EQ(numbers_sent(), (Numbers{1, 2, 3, 4, 5, 3, 4, 5}));
}

TEST_F(FleetEdge, SendsNoFasterThanToldAndNoMoreThanMayBeUnderWay) {
  for (int i = 0; i < 1'000; ++i) row(i);
  be_born();
  wait(1'000);
  EXPECT_EQ(numbers_sent().size(), settings.rows_per_second);
  for (int i = 0; i < 40; ++i) wait(100);
  EXPECT_LE(numbers_sent().size(), 5U * settings.rows_per_second);
  settings.answer_timeout_ms = 1'000'000;
  EdgeNode patient(settings, journal, broker, 2);
  broker.published.clear();
  patient.tick(now);
  patient.connected(now, true);
  const std::string state = R"({"online":true,"timestamp":1800000000000})";
  patient.message(now, kState, std::as_bytes(std::span(state)));
  for (int i = 0; i < 1'000; ++i) {
    now.steady_ms += 100;
    patient.tick(now);
  }
  EXPECT_EQ(numbers_sent().size(), settings.unacknowledged);
}

// A host that can't keep up with a thousand cabinets would else be sent the same rows for ever.
TEST_F(FleetEdge, SendsFewerAtOnceWhereNoAnswerComes) {
  for (int i = 0; i < 600; ++i) row(i);
  be_born();
  wait_long(5);
  const std::size_t at_first = numbers_sent().size();
  EXPECT_GE(at_first, 4U * settings.rows_per_second);
  wait_long(9);
  EXPECT_NEAR(static_cast<double>(numbers_sent().size() - at_first), settings.unacknowledged / 4.0,
              1.0);
  const std::size_t before_answer = numbers_sent().size();
  acknowledge(100);
  wait_long(4);
  EXPECT_NEAR(static_cast<double>(numbers_sent().size() - before_answer), 200, 1.0)
      << "the hundred that arrived, and a hundred more";
}

TEST_F(FleetEdge, ConnectionThatTakesNothingLosesNothing) {
  be_born();
  row(1);
  row(2);
  broker.takes = false;
  wait(1'000);
  broker.takes = true;
  wait(1'000);
  EXPECT_EQ(numbers_sent(), (Numbers{1, 2}));
  EXPECT_EQ(sent(kData)[0].seq, 1U);
}

TEST_F(FleetEdge, ReconnectsMoreAndMoreSlowlyAndNotAllAtOnce) {
  std::vector<std::uint64_t> waits;
  for (int i = 0; i < 10; ++i) {
    const std::uint64_t begin = now.steady_ms;
    while (node.state() == State::kApart) wait(100);
    waits.push_back(now.steady_ms - begin);
    node.lost(now);
  }
  EXPECT_GT(waits[9], 29'000U);
  EXPECT_LE(waits[9], 60'100U);
  EXPECT_LE(waits[1], 1'100U);
  EdgeNode other(settings, journal, broker, 12345);
  other.tick(now);
  other.lost(now);
  EXPECT_NE(waits[8], waits[9]);
}

TEST_F(FleetEdge, ConnectWithoutAnAnswerIsGivenUp) {
  node.tick(now);
  wait(9'900);
  EXPECT_EQ(node.state(), State::kConnecting);
  wait(200);
  EXPECT_EQ(node.state(), State::kApart);
  EXPECT_EQ(broker.calls.back(), "disconnect");
}

TEST_F(FleetEdge, RowThatCouldNotBeKeptIsToldAgain) {
  const Reading mode{Item::kMode, Text("idle")};
  storage.full = true;
  EXPECT_FALSE(node.report(now, {&mode, 1}));
  storage.full = false;
  ASSERT_TRUE(node.report(now, {&mode, 1}));
  be_born();
  wait(100);
  ASSERT_EQ(sent(kData).size(), 1U);
  EXPECT_EQ(*sent(kData)[0].find(Item::kMode), Value(Text("idle")));
}

TEST_F(FleetEdge, ManyLongTextsTakeSeveralRows) {
  const Text longest(std::string(Text::kLongest, 'x'));
  const std::array<Reading, 4> texts{Reading{Item::kMode, longest}, Reading{Item::kFault, longest},
                                     Reading{Item::kArm, longest}, Reading{Item::kSerial, longest}};
  ASSERT_TRUE(node.report(now, texts));
  EXPECT_EQ(journal.last(), 2U);
  be_born();
  wait(1'000);
  ASSERT_EQ(sent(kData).size(), 2U);
  EXPECT_EQ(*sent(kData)[1].find(Item::kSerial), Value(longest));
}

}  // namespace
}  // namespace armsig::fleet::test
