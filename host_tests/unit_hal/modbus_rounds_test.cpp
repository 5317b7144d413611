// SPDX-License-Identifier: MIT
// Several units on one line, read round by round in virtual time.
#include <chrono>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "hal/modbus/range_sensor.hpp"
#include "hal/modbus/round.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/range_readings.hpp"
#include "host_tests/support/register_server.hpp"

namespace armsig::modbus {
namespace {

using std::chrono::milliseconds;
using test::at_ms;

// Carries each request to the server, and its answer back at once.
class ServedLine final : public hal::ByteStream {
 public:
  test::RegisterServer server;
  std::vector<std::vector<std::uint8_t>> requests;

 private:
  Result<void> do_write(std::span<const std::uint8_t> out) override {
    requests.emplace_back(out.begin(), out.end());
    waiting_ = server.answer(requests.back());
    return {};
  }
  Result<std::size_t> do_read(std::span<std::uint8_t> into) override {
    const std::size_t count = std::min(into.size(), waiting_.size());
    std::copy_n(waiting_.begin(), count, into.begin());
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }

  std::vector<std::uint8_t> waiting_;
};

// Three units with a distance in 0.1 mm each, the first with a thermometer and a counter as well.
struct ThreeUnits {
  ThreeUnits() {
    for (std::uint8_t unit = 1; unit <= 3; ++unit) {
      profile.channels.push_back({.field = {.unit = unit, .first = 5, .step = 1e-4}});
      line.server.units[unit].functions[4][5] = static_cast<std::uint16_t>(10'000 * unit);
    }
    profile.distance = true;
    profile.air = Field{.unit = 1, .first = 6, .format = Format::kI16, .step = 0.1};
    profile.update_period = milliseconds(100);
    line.server.units[1].functions[4][6] = 215;
    line.server.units[1].functions[4][7] = 1;
  }

  RangeSensorConfiguration configuration() const { return {.channels = profile}; }

  // What poll() says first from now on, within `time`; empty: nothing.
  std::optional<Result<hal::RangeReading>> next(RangeSensor& sensor,
                                                hal::Duration time = milliseconds(1000)) {
    for (const hal::Instant end = now + time; now < end;) {
      now += milliseconds(1);
      const auto polled = sensor.poll(now);
      if (!polled) return std::unexpected(polled.error());
      if (*polled) return **polled;
    }
    return std::nullopt;
  }

  ServedLine line;
  ChannelProfile profile;
  hal::Instant now{milliseconds(10'000)};
};

TEST(ModbusRounds, bring_a_reading_of_several_units_and_their_air) {
  ThreeUnits three;
  RangeSensor sensor(three.configuration(), three.line);
  const auto reading = three.next(sensor);
  ASSERT_TRUE(reading && *reading);
  ASSERT_EQ((*reading)->receivers.size(), 3U);
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_TRUE((*reading)->receivers[j].valid);
    // 331.3 sqrt(1 + 21.5 / 273.15) m/s, by which the controller makes ranges of times.
    EXPECT_NEAR((*reading)->receivers[j].flight_s * 344.0915884831723, 1.0 + static_cast<double>(j),
                1e-9);
  }
  EXPECT_DOUBLE_EQ((*reading)->air_celsius, 21.5);
  EXPECT_EQ(three.line.requests.size(), 3U) << "the thermometer comes with the first unit";
}

TEST(ModbusRounds, are_by_the_fixed_speed_of_the_sensor_where_there_is_one) {
  ThreeUnits three;
  three.profile.sound_m_s = 340;
  RangeSensor sensor(three.configuration(), three.line);
  const auto reading = three.next(sensor);
  ASSERT_TRUE(reading && *reading);
  EXPECT_DOUBLE_EQ((*reading)->receivers[0].flight_s, 1.0 / 340);
}

TEST(ModbusRounds, take_a_fixed_temperature_where_there_is_no_thermometer) {
  ThreeUnits three;
  three.profile.air.reset();
  three.profile.fixed_air_celsius = 19;
  RangeSensor sensor(three.configuration(), three.line);
  const auto reading = three.next(sensor);
  ASSERT_TRUE(reading && *reading);
  EXPECT_EQ((*reading)->air_celsius, 19);
}

TEST(ModbusRounds, leave_out_a_unit_that_fails_and_count_the_others) {
  using Unit = test::RegisterServer::Unit;
  const std::vector<void (*)(Unit&)> faults{
      [](Unit& unit) { unit.silent = true; }, [](Unit& unit) { unit.exception = 4; },
      [](Unit& unit) { unit.answers_as = 3; }, [](Unit& unit) { unit.short_of_one = true; },
      [](Unit& unit) { unit.functions.clear(); }};
  for (std::size_t k = 0; k < faults.size(); ++k) {
    ThreeUnits three;
    faults[k](three.line.server.units[2]);
    RangeSensor sensor(three.configuration(), three.line);
    for (int round = 0; round < 3; ++round) {
      const auto reading = three.next(sensor);
      ASSERT_TRUE(reading && *reading) << k;
      EXPECT_TRUE((*reading)->receivers[0].valid) << k;
      EXPECT_FALSE((*reading)->receivers[1].valid) << k;
      EXPECT_TRUE((*reading)->receivers[2].valid) << k;
    }
    three.line.server.units[2] = Unit{.functions = {{4, {{5, 20'000}}}}};
    const auto again = three.next(sensor);
    ASSERT_TRUE(again && *again) << k;
    EXPECT_TRUE((*again)->receivers[1].valid) << k;
  }
}

TEST(ModbusRounds, hear_nothing_of_a_receiver_without_an_echo) {
  ThreeUnits three;
  three.profile.channels[0].invalid = {65535};
  three.line.server.units[1].functions[4][5] = 65535;
  three.line.server.units[2].functions[4][5] = 0;
  RangeSensor sensor(three.configuration(), three.line);
  const auto reading = three.next(sensor);
  ASSERT_TRUE(reading && *reading);
  EXPECT_FALSE((*reading)->receivers[0].valid);
  EXPECT_FALSE((*reading)->receivers[1].valid);
  EXPECT_TRUE((*reading)->receivers[2].valid);
}

TEST(ModbusRounds, of_units_that_are_all_silent_are_a_silent_sensor) {
  ThreeUnits three;
  for (auto& [number, unit] : three.line.server.units) unit.silent = true;
  RangeSensor sensor(three.configuration(), three.line);
  const hal::Instant begin = three.now;
  const auto told = three.next(sensor);
  ASSERT_TRUE(told);
  EXPECT_EQ(test::failure_of(*told), Error::kSensorSilent);
  EXPECT_GT(three.now - begin, milliseconds(500)) << "after the time allowed";
}

TEST(ModbusRounds, of_units_that_all_refuse_tell_the_first_error_that_is_not_silence) {
  ThreeUnits three;
  three.line.server.units[1].silent = true;
  three.line.server.units[2].exception = 2;
  three.line.server.units[3].answers_as = 9;
  RangeSensor sensor(three.configuration(), three.line);
  const auto told = three.next(sensor);
  ASSERT_TRUE(told);
  EXPECT_EQ(test::failure_of(*told), Error::kSensorException);
  EXPECT_EQ(sensor.exception_code(), 2);
  EXPECT_EQ(sensor.words(Error::kSensorException), "illegal data address");
}

TEST(ModbusRounds, without_their_air_are_no_reading) {
  ThreeUnits three;
  three.line.server.units[1].exception = 6;
  RangeSensor sensor(three.configuration(), three.line);
  const auto told = three.next(sensor);
  ASSERT_TRUE(told);
  EXPECT_EQ(test::failure_of(*told), Error::kSensorException);
}

TEST(ModbusRounds, with_air_that_is_no_number_are_malformed) {
  ThreeUnits three;
  three.profile.air = Field{.unit = 1, .first = 6, .format = Format::kF32};
  three.line.server.units[1].functions[4][6] = 0x7FC0;
  RangeSensor sensor(three.configuration(), three.line);
  const auto told = three.next(sensor);
  ASSERT_TRUE(told);
  EXPECT_EQ(test::failure_of(*told), Error::kSensorMalformed);
}

// Its late answer would be taken for the one to the other request.
TEST(ModbusRounds, ask_a_unit_that_failed_no_more_in_the_same_round) {
  ThreeUnits three;
  three.profile.channels[1].field = {.unit = 1, .first = 500};
  three.profile.channels[2].field = {.unit = 2, .first = 5};
  three.line.server.units[1].silent = true;
  three.profile.air.reset();
  RangeSensor sensor(three.configuration(), three.line);
  const auto reading = three.next(sensor);
  ASSERT_TRUE(reading && *reading);
  EXPECT_EQ(three.line.server.units[1].requests, 1U);
  EXPECT_FALSE((*reading)->receivers[1].valid);
  EXPECT_TRUE((*reading)->receivers[2].valid);
}

// Without a counter each round is a reading, and two are never nearer than the sensor's period.
TEST(ModbusRounds, are_new_readings_by_time_where_nothing_counts_them) {
  ThreeUnits three;
  RangeSensor sensor(three.configuration(), three.line);
  std::optional<std::uint32_t> sequence;
  std::optional<hal::Instant> before;
  for (int round = 0; round < 4; ++round) {
    const auto reading = three.next(sensor);
    ASSERT_TRUE(reading && *reading);
    EXPECT_NE((*reading)->sequence, sequence);
    sequence = (*reading)->sequence;
    if (before) {
      EXPECT_GE(three.now - *before, milliseconds(100));
      EXPECT_LT(three.now - *before, milliseconds(115));
    }
    before = three.now;
  }
}

// What a unit shows may have been measured a period before it was asked.
TEST(ModbusRounds, are_as_old_as_the_oldest_value_in_them_may_be) {
  ThreeUnits three;
  RangeSensor sensor(three.configuration(), three.line);
  const hal::Instant begin = three.now + milliseconds(1);
  const auto reading = three.next(sensor);
  ASSERT_TRUE(reading && *reading);
  EXPECT_EQ((*reading)->at, begin - milliseconds(100));
  EXPECT_GT(three.now, begin);
}

TEST(ModbusRounds, are_one_reading_as_long_as_the_counter_stands_and_stale_at_last) {
  ThreeUnits three;
  three.profile.counter = Field{.unit = 1, .first = 7};
  three.profile.update_period = {};
  RangeSensor sensor(three.configuration(), three.line);
  const auto first = three.next(sensor);
  ASSERT_TRUE(first && *first);
  EXPECT_EQ((*first)->sequence, 1U);
  EXPECT_EQ((*first)->at, hal::Instant{}) << "nobody knows since when it has stood there";
  EXPECT_FALSE(three.next(sensor, milliseconds(300)));
  const hal::Instant before = three.now;
  three.line.server.units[1].functions[4][7] = 2;
  const auto second = three.next(sensor);
  ASSERT_TRUE(second && *second);
  EXPECT_EQ((*second)->sequence, 2U);
  EXPECT_LE((*second)->at, before);
  EXPECT_GE((*second)->at, before - milliseconds(25)) << "younger than the last look";
  const auto stale = three.next(sensor);
  ASSERT_TRUE(stale);
  EXPECT_EQ(test::failure_of(*stale), Error::kSensorStale);
}

TEST(ModbusRounds, without_their_counter_are_no_reading) {
  ThreeUnits three;
  three.profile.counter = Field{.unit = 9, .first = 7};
  RangeSensor sensor(three.configuration(), three.line);
  const auto told = three.next(sensor);
  ASSERT_TRUE(told);
  EXPECT_EQ(test::failure_of(*told), Error::kSensorSilent);
}

TEST(ModbusRounds, keep_the_pause_of_the_line_between_two_requests) {
  ThreeUnits three;
  RangeSensorConfiguration configuration = three.configuration();
  configuration.timing.baud = 9600;  // 4.01 ms
  RangeSensor sensor(configuration, three.line);
  const hal::Instant begin = three.now;
  const auto reading = three.next(sensor);
  ASSERT_TRUE(reading && *reading);
  EXPECT_GE(three.now - begin, 2 * frame_pause(9600));
}

}  // namespace
}  // namespace armsig::modbus
