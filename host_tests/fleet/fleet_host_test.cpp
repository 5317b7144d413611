// SPDX-License-Identifier: MIT
// What the host takes, asks for and acknowledges, without broker and record.
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "firmware/fleet/host/arm_page.hpp"
#include "firmware/fleet/host/configuration.hpp"
#include "firmware/fleet/host/html.hpp"
#include "firmware/fleet/host/intake.hpp"
#include "firmware/fleet/host/page.hpp"
#include "firmware/fleet/host/row_text.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::fleet {
namespace {

constexpr std::uint64_t kName = 77;

class FleetIntake : public testing::Test {
 protected:
  void SetUp() override { intake.begin({}); }

  void birth(std::uint8_t session = 0) {
    const Payload payload = encode_birth(1, session, {});
    intake.birth("arm-1", {payload.data(), payload.size()});
    seq = 1;
  }
  void death(std::uint8_t session) {
    const Payload payload = encode_death(1, session);
    intake.death("arm-1", {payload.data(), payload.size()});
  }
  void row(std::uint64_t number, std::uint64_t previous) {
    RowMessage message{.journal = kName,
                       .number = number,
                       .previous = previous,
                       .dropped = 0,
                       .time_ms = 5,
                       .historical = false,
                       .readings = {}};
    message.readings.push_back({Item::kAir, 20.0});
    const Payload payload = encode_row(9, seq++, message);
    intake.data("arm-1", {payload.data(), payload.size()});
  }
  std::vector<std::uint64_t> taken() {
    std::vector<std::uint64_t> numbers;
    for (const StoredRow& stored : intake.waiting().rows) numbers.push_back(stored.number);
    return numbers;
  }
  void commit() { intake.stored(intake.take_batch()); }

  Intake intake;
  std::uint8_t seq = 0;
  using Numbers = std::vector<std::uint64_t>;
};

TEST_F(FleetIntake, RowsAreTakenInTheirChain) {
  birth();
  row(1, 0);
  row(2, 1);
  row(300, 2);  // the cabinet was restarted
  EXPECT_EQ(taken(), (Numbers{1, 2, 300}));
}

TEST_F(FleetIntake, RowThatCameBeforeIsNotTakenAgain) {
  birth();
  row(1, 0);
  commit();
  row(1, 0);
  row(2, 1);
  EXPECT_EQ(taken(), Numbers{2});
  EXPECT_EQ(intake.counts().repeated, 1U);
}

TEST_F(FleetIntake, RowWithoutTheOneBeforeWaitsUntilItIsSentInOrder) {
  birth();
  row(1, 0);
  row(3, 2);
  EXPECT_EQ(taken(), Numbers{1});
  row(2, 1);
  row(3, 2);
  EXPECT_EQ(taken(), (Numbers{1, 2, 3}));
}

TEST_F(FleetIntake, WhatTheRingHasLostIsPassedOver) {
  birth();
  row(1, 0);
  row(500, 0);
  EXPECT_EQ(taken(), (Numbers{1, 500}));
}

TEST_F(FleetIntake, OnlyWhatIsCommittedIsAcknowledgedOnceASecond) {
  birth();
  row(1, 0);
  ASSERT_EQ(intake.acknowledgements(10'000).size(), 1U);
  const Batch batch = intake.take_batch();
  row(2, 1);
  intake.stored(batch);
  EXPECT_TRUE(intake.acknowledgements(10'900).empty());
  const auto told = intake.acknowledgements(11'000);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].journal, kName);
  EXPECT_EQ(told[0].number, 1U) << "2 is taken, and not committed";
  commit();
  EXPECT_EQ(intake.acknowledgements(12'000).at(0).number, 2U);
  EXPECT_TRUE(intake.acknowledgements(20'000).empty());
}

TEST_F(FleetIntake, GapInSeqAsksForARebirthAndTakesNothingUntilThen) {
  birth();
  row(1, 0);
  ++seq;
  row(2, 1);
  EXPECT_EQ(taken(), Numbers{1});
  EXPECT_EQ(intake.rebirths(10'000), std::vector<std::string>{"arm-1"});
  EXPECT_TRUE(intake.rebirths(14'000).empty());
  EXPECT_EQ(intake.rebirths(15'000).size(), 1U);
  row(2, 1);
  EXPECT_EQ(taken(), Numbers{1});
  birth();
  row(2, 1);
  EXPECT_EQ(taken(), (Numbers{1, 2}));
  EXPECT_TRUE(intake.rebirths(30'000).empty());
}

TEST_F(FleetIntake, DataOfOneThatWasNeverBornAskForItsBirth) {
  row(1, 0);
  EXPECT_TRUE(intake.waiting().empty());
  EXPECT_EQ(intake.rebirths(10'000).size(), 1U);
}

TEST_F(FleetIntake, DeathOfASessionThatIsOverIsIgnored) {
  birth(3);
  birth(4);
  death(3);
  EXPECT_EQ(intake.online(), 1U);
  death(4);
  EXPECT_EQ(intake.online(), 0U);
  EXPECT_FALSE(intake.waiting().states.back().online);
}

TEST_F(FleetIntake, WithoutARecordNothingIsTaken) {
  birth();
  row(1, 0);
  intake.end();
  EXPECT_TRUE(intake.waiting().empty());
  birth();
  row(1, 0);
  EXPECT_TRUE(intake.waiting().empty());
  intake.begin({{"arm-1", kName, 1}});
  EXPECT_EQ(intake.rebirths(10'000).size(), 1U);
  birth();
  row(1, 0);
  row(2, 1);
  EXPECT_EQ(taken(), Numbers{2}) << "the record has the first";
}

TEST_F(FleetIntake, WhatIsNoRowIsCountedAndTakenForNothing) {
  birth();
  row(0, 0);
  row(5, 5);
  row(std::uint64_t{1} << 63U, 0);
  const std::string noise = "\xff\xff";
  intake.data("arm-1", std::as_bytes(std::span(noise)));
  intake.birth("arm-1", std::as_bytes(std::span(noise)));
  EXPECT_TRUE(taken().empty());
  EXPECT_EQ(intake.counts().malformed, 5U);
}

TEST_F(FleetIntake, FiguresAreToldWithoutARecord) {
  birth();
  row(1, 0);
  const Answer metrics = answer("/metrics", intake, nullptr);
  EXPECT_EQ(metrics.status, 200);
  EXPECT_NE(metrics.body.find("\narmsig_rows_total 1\n"), std::string::npos);
  EXPECT_NE(metrics.body.find("\narmsig_arms_online 1\n"), std::string::npos);
  EXPECT_NE(metrics.body.find("\narmsig_record_up 0\n"), std::string::npos);
  EXPECT_EQ(answer("/", intake, nullptr).status, 503);
  EXPECT_EQ(answer("/etc/passwd", intake, nullptr).status, 404);
}

TEST(FleetPage, NothingThatAnArmSaysIsMarkup) {
  EXPECT_EQ(escaped("<script>&\"x\""), "&lt;script&gt;&amp;&quot;x&quot;");
}

TEST(FleetPage, OnlyWhatIsAHashIsLookedFor) {
  const std::string hash(64, 'a');
  EXPECT_TRUE(is_of_one_arm("/arm/x"));
  EXPECT_TRUE(is_of_one_arm("/signature/" + hash));
  EXPECT_TRUE(is_of_one_arm("/compare/" + hash + "/" + hash));
  EXPECT_FALSE(is_of_one_arm("/signature/" + hash + "a"));
  EXPECT_FALSE(is_of_one_arm("/signature/" + std::string(64, 'A')));
  EXPECT_FALSE(is_of_one_arm("/compare/" + hash + hash + "a"));
}

TEST(FleetRowText, ReadingsAreJson) {
  Readings readings;
  readings.push_back({Item::kNumber, std::uint64_t{1}});
  readings.push_back({Item::kMode, Text("a\"b\\c\xff")});
  readings.push_back({Item::kAir, -0.5});
  readings.push_back({Item::kFault, Value()});
  EXPECT_EQ(json_of(readings), R"({"mode":"a\"b\\c?","air_c":-0.5,"fault":null})");
}

// Numbers whose squares a database cannot hold never come to it.
TEST_F(FleetIntake, NumbersAreBoundedOnBothSides) {
  Readings birth;
  birth.push_back({Item::kCheckSigma, 1e-200});
  const Payload born = encode_birth(1, 0, birth);
  intake.birth("arm-1", {born.data(), born.size()});
  seq = 1;
  RowMessage message{.journal = kName,
                     .number = 1,
                     .previous = 0,
                     .dropped = 0,
                     .time_ms = 5,
                     .historical = false,
                     .readings = {}};
  const std::array<std::pair<Item, double>, 4> sent{{{Item::kResidualX, 1e-200},
                                                     {Item::kResidualY, -1e200},
                                                     {Item::kResidualZ, 0.25},
                                                     {Item::kAir, std::nan("")}}};
  for (const auto& [item, value] : sent) message.readings.push_back({item, value});
  const Payload payload = encode_row(9, seq++, message);
  intake.data("arm-1", {payload.data(), payload.size()});
  const Batch batch = intake.take_batch();
  const auto value_of = [](const Readings& readings, Item item) {
    for (const Reading& reading : readings) {
      if (reading.item == item) return reading.value;
    }
    return Value(false);
  };
  ASSERT_EQ(batch.rows.size(), 1U);
  EXPECT_EQ(value_of(batch.rows[0].readings, Item::kResidualX), Value(0.0));
  EXPECT_EQ(value_of(batch.rows[0].readings, Item::kResidualY), Value());
  EXPECT_EQ(value_of(batch.rows[0].readings, Item::kResidualZ), Value(0.25));
  EXPECT_EQ(value_of(batch.rows[0].readings, Item::kAir), Value());
  ASSERT_EQ(batch.states.size(), 1U);
  EXPECT_EQ(value_of(batch.states[0].current, Item::kCheckSigma), Value(0.0));
}

TEST(FleetHostConfiguration, ExampleTellsTheDefaults) {
  const auto read = read_host_configuration(ARMSIG_EXAMPLE);
  ASSERT_TRUE(read) << tool::render(read.error());
  const DriftPlan plain;
  EXPECT_EQ(read->drift.pose_sigma_mm, plain.pose_sigma_mm);
  EXPECT_EQ(read->drift.poses, plain.poses);
  EXPECT_EQ(read->drift.shift_mm, plain.shift_mm);
  EXPECT_EQ(read->drift.baseline, plain.baseline);
  EXPECT_EQ(read->drift.correlation, plain.correlation);
  EXPECT_EQ(read->drift.sigma_ratio, plain.sigma_ratio);
  EXPECT_EQ(read->drift.checks_per_month, plain.checks_per_month);
  EXPECT_EQ(read->drift.false_alarms_per_1000_arm_months, plain.false_alarms_per_1000_arm_months);
  EXPECT_EQ(read->page_port, HostConfiguration{}.page_port);
  EXPECT_EQ(read->broker.port, 8883);
}

TEST(FleetHostConfiguration, IsCheckedAsAWhole) {
  const std::string good =
      "armsig: fleet/1\ngroup: plant\nhost: fleet\ndatabase: dbname=armsig\n"
      "broker: {address: localhost}\ndrift: {poses: 16, correlation: 0.2}\n";
  const auto read = parse_host_configuration(good, "fleet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  EXPECT_EQ(read->drift.poses, 16);
  EXPECT_EQ(read->page_port, 8080);
  const auto named =
      parse_host_configuration(good + "page_names: [fleet.plant.example]\n", "fleet.yaml");
  ASSERT_TRUE(named) << tool::render(named.error());
  EXPECT_EQ(named->page_names, std::vector<std::string>{"fleet.plant.example"});
  for (const char* more : {"page_port: 0\n", "colour: red\n", "group: again\n", "page_names: []\n",
                           "page_names: [\"a b\"]\n", "page_names: [\"fleet:8080\"]\n"}) {
    EXPECT_FALSE(parse_host_configuration(good + more, "fleet.yaml")) << more;
  }
  const std::string wrong =
      "armsig: fleet/1\ngroup: plant\nhost: fleet\ndatabase: dbname=armsig\n"
      "broker: {address: localhost}\ndrift: {correlation: 1}\n";
  const auto said = tool::render(test::failure_of(parse_host_configuration(wrong, "fleet.yaml")));
  EXPECT_NE(said.find("correlation"), std::string::npos) << said;
}

}  // namespace
}  // namespace armsig::fleet
