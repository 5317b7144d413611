// SPDX-License-Identifier: MIT
// The bounds of profiles, pauses and time-outs from both sides, to the register and to the
// nanosecond.
#include <chrono>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "hal/freshness.hpp"
#include "hal/modbus/profile.hpp"
#include "hal/modbus/range_sensor.hpp"
#include "hal/modbus/rtu.hpp"
#include "hal/modbus/rtu_master.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/range_readings.hpp"
#include "host_tests/support/scripted_line.hpp"

namespace armsig::modbus {
namespace {

using std::chrono::milliseconds;
using test::at_ms;
using test::bytes;
using test::ScriptedLine;

constexpr const char* kAnswer = "010418000F000700E600040016E3600016E3610016E3620016E363169A";
constexpr ReadRequest kRead{1, 4, {0, 12}};
constexpr hal::Duration kPause = std::chrono::microseconds(1750);

TEST(ModbusProfileBounds, are_part_of_what_is_accepted) {
  EXPECT_TRUE(registers_of({.unit = 1}));
  EXPECT_TRUE(registers_of({.unit = 247}));
  EXPECT_TRUE(registers_of({.function = 3}));
  EXPECT_TRUE(registers_of({.function = 4}));
  EXPECT_TRUE(registers_of({.receivers = 1}));
  EXPECT_TRUE(registers_of({.receivers = 16}));
  EXPECT_FALSE(registers_of({.function = 2}));
  EXPECT_FALSE(registers_of({.function = 5}));
  for (const double step : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_FALSE(registers_of({.celsius_a_step = step}));
    EXPECT_FALSE(registers_of({.seconds_a_step = step}));
  }
}

TEST(ModbusProfileBounds, one_request_takes_125_registers) {
  const auto most = registers_of({.first_flight = 117});
  ASSERT_TRUE(most);
  EXPECT_EQ(most->first, 0);
  EXPECT_EQ(most->count, 125);
  EXPECT_EQ(test::failure_of(registers_of({.first_flight = 118})), Error::kProfileInvalid);
}

TEST(ModbusProfileBounds, registers_end_at_65535) {
  const Profile last{.status = 65500,
                     .sequence = 65501,
                     .air_temperature = 65502,
                     .receiver_count = 65503,
                     .first_flight = 65528};
  const auto range = registers_of(last);
  ASSERT_TRUE(range);
  EXPECT_EQ(range->first, 65500);
  EXPECT_EQ(range->count, 36);
  Profile beyond = last;
  beyond.first_flight = 65529;
  EXPECT_EQ(test::failure_of(registers_of(beyond)), Error::kProfileInvalid);
}

TEST(ModbusProfileBounds, the_first_register_may_be_a_flight_time_and_the_last_a_single) {
  const auto range = registers_of({.status = 20,
                                   .sequence = 21,
                                   .air_temperature = 22,
                                   .receiver_count = 23,
                                   .first_flight = 10});
  ASSERT_TRUE(range);
  EXPECT_EQ(range->first, 10);
  EXPECT_EQ(range->count, 14);
}

TEST(ModbusException, has_words_of_its_own_for_each_code) {
  std::set<std::string_view> words;
  for (const std::uint8_t code : std::initializer_list<std::uint8_t>{1, 2, 3, 4, 5, 6, 8, 10, 11}) {
    words.insert(describe_exception(code));
  }
  EXPECT_EQ(words.size(), 9U);
  EXPECT_FALSE(words.contains("unknown exception"));
  for (const std::uint8_t code : std::initializer_list<std::uint8_t>{0, 7, 9, 12, 255}) {
    EXPECT_EQ(describe_exception(code), "unknown exception");
  }
}

// The CRC of each is right, so that what else is wrong is looked at.
Error with_crc(std::vector<std::uint8_t> answer) {
  const std::uint16_t crc = crc16(answer);
  answer.push_back(static_cast<std::uint8_t>(crc & 0xFF));
  answer.push_back(static_cast<std::uint8_t>(crc >> 8));
  return test::failure_of(decode(kRead, answer)).error;
}

TEST(ModbusAnswer, has_the_length_it_says_and_the_one_asked_for) {
  std::vector<std::uint8_t> answer = bytes(kAnswer);
  answer.resize(answer.size() - 2);
  std::vector<std::uint8_t> longer = answer;
  longer.push_back(0);
  EXPECT_EQ(with_crc(longer), Error::kSensorMalformed);
  std::vector<std::uint8_t> says = answer;
  says[2] = 22;
  EXPECT_EQ(with_crc(says), Error::kSensorMalformed);
  EXPECT_EQ(with_crc({1, 0x84, 2, 0}), Error::kSensorMalformed) << "an exception of six bytes";
}

TEST(RtuMaster, is_idle_after_the_pause_to_the_nanosecond) {
  ScriptedLine line;
  line.answer = bytes(kAnswer);
  RtuMaster master({}, line);
  EXPECT_TRUE(master.idle(at_ms(0)));
  ASSERT_TRUE(master.start(kRead, at_ms(0)));
  EXPECT_FALSE(master.idle(at_ms(1000))) << "while an answer is awaited";
  const auto answer = master.poll(at_ms(5));
  ASSERT_TRUE(answer && *answer);
  EXPECT_FALSE(master.idle(at_ms(5) + kPause - hal::Duration(1)));
  EXPECT_TRUE(master.idle(at_ms(5) + kPause));
  EXPECT_FALSE(master.poll(at_ms(6)).has_value()) << "nothing was asked for";
}

TEST(RtuMaster, ends_an_answer_by_the_pause_and_silence_by_the_time_allowed) {
  ScriptedLine line;
  RtuMaster master({}, line);
  ASSERT_TRUE(master.start(kRead, at_ms(0)));
  EXPECT_FALSE(master.poll(at_ms(99) + std::chrono::microseconds(999)));
  const auto silent = master.poll(at_ms(100));
  ASSERT_TRUE(silent);
  EXPECT_EQ(test::failure_of(*silent).error, Error::kSensorSilent);
  ASSERT_TRUE(master.start(kRead, at_ms(200)));
  line.bring(bytes("0104"));
  EXPECT_FALSE(master.poll(at_ms(201)));
  EXPECT_FALSE(master.poll(at_ms(201) + kPause - hal::Duration(1)));
  const auto cut = master.poll(at_ms(201) + kPause);
  ASSERT_TRUE(cut);
  EXPECT_EQ(test::failure_of(*cut).error, Error::kSensorMalformed);
}

// A line that never stops: the frame is full, and judged.
TEST(RtuMaster, ends_a_babbling_answer_at_a_whole_frame) {
  ScriptedLine line;
  RtuMaster master({}, line);
  ASSERT_TRUE(master.start(kRead, at_ms(0)));
  line.bring(std::vector<std::uint8_t>(300, 0xFF));
  const auto full = master.poll(at_ms(1));
  ASSERT_TRUE(full);
  EXPECT_EQ(test::failure_of(*full).error, Error::kSensorBadCrc);
}

TEST(RtuMaster, tells_a_line_that_goes_while_an_answer_is_awaited) {
  ScriptedLine line;
  RtuMaster master({}, line);
  ASSERT_TRUE(master.start(kRead, at_ms(0)));
  line.down = true;
  const auto gone = master.poll(at_ms(1));
  ASSERT_TRUE(gone);
  EXPECT_EQ(test::failure_of(*gone).error, Error::kBusDown);
  EXPECT_FALSE(master.poll(at_ms(2)).has_value()) << "the request has ended";
  EXPECT_EQ(test::failure_of(master.start(kRead, at_ms(10))), Error::kBusDown);
}

TEST(ModbusRangeSensor, asks_again_after_its_period_and_has_words_for_an_exception_alone) {
  ScriptedLine line;
  line.answer = bytes("018402C2C1");
  RangeSensor sensor({}, line);
  EXPECT_TRUE(sensor.poll(at_ms(0)));
  EXPECT_EQ(test::failure_of(sensor.poll(at_ms(1))), Error::kSensorException);
  EXPECT_TRUE(sensor.poll(at_ms(20) - hal::Duration(1)));
  EXPECT_EQ(line.written.size(), 1U);
  EXPECT_TRUE(sensor.poll(at_ms(20)));
  EXPECT_EQ(line.written.size(), 2U);
  EXPECT_EQ(sensor.words(Error::kSensorException), "illegal data address");
  EXPECT_EQ(sensor.words(Error::kSensorSilent), "");
}

TEST(Freshness, tells_silence_and_standing_still_after_their_times_and_again) {
  hal::Freshness freshness({.silent_after = milliseconds(100), .stale_after = milliseconds(40)});
  EXPECT_FALSE(freshness.overdue(at_ms(0)));
  EXPECT_FALSE(freshness.overdue(at_ms(100))) << "nothing was ever heard to stand still";
  EXPECT_EQ(freshness.overdue(at_ms(101)), Error::kSensorSilent);
  EXPECT_FALSE(freshness.overdue(at_ms(201)));
  EXPECT_EQ(freshness.overdue(at_ms(202)), Error::kSensorSilent);
  EXPECT_TRUE(freshness.take(0, at_ms(210)));
  EXPECT_FALSE(freshness.take(0, at_ms(240)));
  EXPECT_FALSE(freshness.overdue(at_ms(250)));
  EXPECT_EQ(freshness.overdue(at_ms(251)), Error::kSensorStale);
  EXPECT_FALSE(freshness.take(0, at_ms(260)));
  EXPECT_FALSE(freshness.overdue(at_ms(291)));
  EXPECT_EQ(freshness.overdue(at_ms(292)), Error::kSensorStale);
  EXPECT_TRUE(freshness.take(1, at_ms(300)));
  EXPECT_FALSE(freshness.overdue(at_ms(340)));
}

TEST(ModbusRtu, looks_at_both_bytes_of_the_check) {
  for (const char* answer : {"018402C3C1", "018402C2C0"}) {  // of 018402C2C1
    const auto decoded = decode({1, 4, {0, 12}}, bytes(answer));
    ASSERT_FALSE(decoded) << answer;
    EXPECT_EQ(test::failure_of(decoded).error, Error::kSensorBadCrc) << answer;
  }
}

TEST(ModbusProfile, that_contradicts_itself_decodes_nothing) {
  const std::vector<std::uint16_t> registers(12);
  const auto reading = decode(Profile{.unit = 0}, registers);
  ASSERT_FALSE(reading);
  EXPECT_EQ(test::failure_of(reading), Error::kProfileInvalid);
}

// A line that never falls silent is read from no longer than it takes; what it brings later is no
// answer.
TEST(ModbusRangeSensor, asks_on_a_line_that_babbles) {
  ScriptedLine line;
  line.bring(std::vector<std::uint8_t>(5'000, 0x55));
  RangeSensor sensor({}, line);
  EXPECT_TRUE(sensor.poll(at_ms(0)));
  EXPECT_EQ(line.written.size(), 1U);
  const auto answered = sensor.poll(at_ms(1));
  ASSERT_FALSE(answered);
  EXPECT_EQ(test::failure_of(answered), Error::kSensorBadCrc);
}

// 255 bytes of registers are more than a frame of 256 has room for: it ends where the frame does.
TEST(ModbusRangeSensor, ends_an_answer_that_is_longer_than_a_frame) {
  ScriptedLine line;
  line.answer = bytes("0104FF");
  line.answer.resize(300);
  RangeSensor sensor({}, line);
  EXPECT_TRUE(sensor.poll(at_ms(0)));
  const auto answered = sensor.poll(at_ms(1));
  ASSERT_FALSE(answered);
  EXPECT_EQ(test::failure_of(answered), Error::kSensorBadCrc);
}

TEST(ModbusRangeSensor, tells_a_sensor_with_fewer_receivers_than_configured) {
  ScriptedLine line;
  line.answer = bytes("010418000F000700E60003");
  line.answer.resize(27);
  const std::uint16_t crc = crc16(line.answer);
  line.answer.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
  line.answer.push_back(static_cast<std::uint8_t>(crc >> 8U));
  RangeSensor sensor({}, line);
  EXPECT_TRUE(sensor.poll(at_ms(0)));
  const auto answered = sensor.poll(at_ms(1));
  ASSERT_FALSE(answered);
  EXPECT_EQ(test::failure_of(answered), Error::kSensorMalformed);
}

// Reads, and takes nothing.
class DeafLine final : public hal::ByteStream {
  Result<void> do_write(std::span<const std::uint8_t> /*out*/) override {
    return std::unexpected(Error::kBusBusy);
  }
  Result<std::size_t> do_read(std::span<std::uint8_t> /*into*/) override { return 0; }
};

TEST(ModbusRangeSensor, tells_that_its_line_takes_no_request) {
  DeafLine line;
  RangeSensor sensor({}, line);
  const auto polled = sensor.poll(at_ms(0));
  ASSERT_FALSE(polled);
  EXPECT_EQ(test::failure_of(polled), Error::kBusBusy);
}

}  // namespace
}  // namespace armsig::modbus
