// SPDX-License-Identifier: MIT
// Frames are written by hand from the Modbus specifications; their checksums come from a Python
// program and agree with pymodbus.
#include <chrono>

#include <gtest/gtest.h>

#include "hal/modbus/profile.hpp"
#include "hal/modbus/range_sensor.hpp"
#include "hal/modbus/rtu.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/range_readings.hpp"
#include "host_tests/support/scripted_line.hpp"

namespace armsig::modbus {
namespace {

using test::at_ms;
using test::bytes;
using test::ScriptedLine;

// Unit 1, function 4, registers 0 to 11.
constexpr const char* kRequest = "01040000000CF00F";
// Four receivers valid, sequence 7, 23.0 degrees C, four receivers, 1500000 to 1500003 ns.
constexpr const char* kAnswer = "010418000F000700E600040016E3600016E3610016E3620016E363169A";
constexpr const char* kOtherUnit = "020418000F000700E600040016E3600016E3610016E3620016E363175D";
constexpr const char* kOtherFunction = "010318000F000700E600040016E3600016E3610016E3620016E363F8E5";
constexpr const char* kOneRegister = "010402000178F0";
constexpr const char* kIllegalAddress = "018402C2C1";
constexpr const char* kOtherException = "018502C351";

constexpr ReadRequest kRead{1, 4, {0, 12}};

Error error_of(const std::string& answer) {
  const auto decoded = decode(kRead, bytes(answer));
  EXPECT_FALSE(decoded);
  return decoded ? Error::kNotFinite : decoded.error().error;
}

TEST(ModbusCrc, has_the_catalogued_check_value) {
  const std::string digits = "123456789";
  EXPECT_EQ(crc16(std::vector<std::uint8_t>(digits.begin(), digits.end())), 0x4B37);
}

TEST(ModbusRtu, encodes_the_request) {
  const auto request = encode(kRead);
  EXPECT_EQ(std::vector<std::uint8_t>(request.begin(), request.end()), bytes(kRequest));
}

TEST(ModbusRtu, decodes_the_answer) {
  const auto registers = decode(kRead, bytes(kAnswer));
  ASSERT_TRUE(registers);
  ASSERT_EQ(registers->size(), 12U);
  EXPECT_EQ((*registers)[2], 230);
  EXPECT_EQ((*registers)[11], 0xE363);
}

TEST(ModbusRtu, refuses_each_kind_of_wrong_answer_by_its_name) {
  std::string flipped = kAnswer;
  flipped[10] = '1';
  EXPECT_EQ(error_of(flipped), Error::kSensorBadCrc);
  EXPECT_EQ(error_of(kOtherUnit), Error::kSensorWrongUnit);
  EXPECT_EQ(error_of(kOtherFunction), Error::kSensorWrongUnit);
  EXPECT_EQ(error_of(kOtherException), Error::kSensorWrongUnit);
  EXPECT_EQ(error_of(kOneRegister), Error::kSensorMalformed);
  EXPECT_EQ(error_of("0104"), Error::kSensorMalformed);
}

TEST(ModbusRtu, keeps_the_code_of_an_exception) {
  const auto decoded = decode(kRead, bytes(kIllegalAddress));
  ASSERT_FALSE(decoded);
  EXPECT_EQ(test::failure_of(decoded).error, Error::kSensorException);
  EXPECT_EQ(describe_exception(test::failure_of(decoded).exception), "illegal data address");
}

TEST(ModbusRtu, knows_how_long_an_answer_is) {
  EXPECT_EQ(answer_bytes(bytes("01")), 0U);
  EXPECT_EQ(answer_bytes(bytes("0104")), 0U);
  EXPECT_EQ(answer_bytes(bytes("010418")), 29U);
  EXPECT_EQ(answer_bytes(bytes("0184")), 5U);
}

TEST(ModbusRtu, pauses_3_5_characters_and_never_less_than_1750_us) {
  EXPECT_EQ(frame_pause(115200), std::chrono::microseconds(1750));
  EXPECT_EQ(frame_pause(9600), std::chrono::nanoseconds(4010416));  // 3.5 * 11 / 9600 s
}

TEST(ModbusProfile, reads_the_default_map_in_one_request) {
  const auto range = registers_of(Profile{});
  ASSERT_TRUE(range);
  EXPECT_EQ(range->first, 0);
  EXPECT_EQ(range->count, 12);
}

TEST(ModbusProfile, decodes_the_default_map) {
  const auto registers = decode(kRead, bytes(kAnswer));
  const auto reading = decode(Profile{}, std::span(registers->data(), registers->size()));
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->sequence, 7U);
  EXPECT_DOUBLE_EQ(reading->air_celsius, 23.0);
  ASSERT_EQ(reading->receivers.size(), 4U);
  EXPECT_TRUE(reading->receivers[3].valid);
  EXPECT_DOUBLE_EQ(reading->receivers[3].flight_s, 1500003e-9);
}

TEST(ModbusProfile, decodes_another_makers_map) {
  const Profile profile{.status = 105,
                        .sequence = 104,
                        .air_temperature = 103,
                        .celsius_a_step = 0.01,
                        .receiver_count = 102,
                        .first_flight = 110,
                        .flight_stride = 4,
                        .seconds_a_step = 1e-8,
                        .high_word_first = false,
                        .echo = true,
                        .receivers = 2};
  const auto range = registers_of(profile);
  ASSERT_TRUE(range);
  EXPECT_EQ(range->first, 102);
  EXPECT_EQ(range->count, 14);  // to register 115
  std::vector<std::uint16_t> registers(14);
  registers[0] = 2;
  registers[1] = static_cast<std::uint16_t>(-150);
  registers[2] = 77;
  registers[3] = 0x2;
  registers[12] = 0x0001;  // low word of receiver 1
  registers[13] = 0x0002;  // high word
  const auto reading = decode(profile, registers);
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->sequence, 77U);
  EXPECT_DOUBLE_EQ(reading->air_celsius, -1.5);
  EXPECT_FALSE(reading->receivers[0].valid);
  EXPECT_TRUE(reading->receivers[1].valid);
  EXPECT_DOUBLE_EQ(reading->receivers[1].flight_s, 0x20001 * 1e-8 / 2);
}

TEST(ModbusProfile, refuses_profiles_that_contradict_themselves) {
  EXPECT_EQ(test::failure_of(registers_of({.unit = 0})), Error::kProfileInvalid);
  EXPECT_EQ(test::failure_of(registers_of({.unit = 248})), Error::kProfileInvalid);
  EXPECT_EQ(test::failure_of(registers_of({.function = 6})), Error::kProfileInvalid);
  EXPECT_EQ(test::failure_of(registers_of({.receivers = 0})), Error::kProfileInvalid);
  EXPECT_EQ(test::failure_of(registers_of({.receivers = 17})), Error::kProfileInvalid);
  EXPECT_EQ(test::failure_of(registers_of({.flight_stride = 1})), Error::kProfileInvalid);
  EXPECT_EQ(test::failure_of(registers_of({.seconds_a_step = 0})), Error::kProfileInvalid);
  EXPECT_EQ(test::failure_of(registers_of({.first_flight = 200})), Error::kProfileInvalid);
  EXPECT_EQ(test::failure_of(registers_of({.status = 65535, .sequence = 65535})),
            Error::kProfileInvalid);
}

TEST(ModbusProfile, refuses_a_sensor_with_fewer_receivers_or_another_number_of_registers) {
  std::vector<std::uint16_t> registers(12);
  registers[3] = 3;
  EXPECT_EQ(test::failure_of(decode(Profile{}, registers)), Error::kSensorMalformed);
  registers.resize(11);
  EXPECT_EQ(test::failure_of(decode(Profile{}, registers)), Error::kSensorMalformed);
}

TEST(ModbusRangeSensor, polls_and_hands_a_reading_out_once) {
  ScriptedLine line;
  line.answer = bytes(kAnswer);
  RangeSensor sensor({}, line);
  EXPECT_FALSE(sensor.poll(at_ms(0))->has_value());
  ASSERT_EQ(line.written.size(), 1U);
  EXPECT_EQ(line.written[0], bytes(kRequest));
  const auto reading = sensor.poll(at_ms(5));
  ASSERT_TRUE(reading && *reading);
  EXPECT_EQ((*reading)->at, at_ms(5));
  EXPECT_FALSE(sensor.poll(at_ms(6))->has_value());
  EXPECT_EQ(line.written.size(), 1U);
  EXPECT_FALSE(sensor.poll(at_ms(20))->has_value());
  EXPECT_EQ(line.written.size(), 2U);
  EXPECT_FALSE(sensor.poll(at_ms(25))->has_value());  // the same sequence again
}

TEST(ModbusRangeSensor, puts_an_answer_in_pieces_together) {
  ScriptedLine line;
  RangeSensor sensor({}, line);
  EXPECT_FALSE(sensor.poll(at_ms(0))->has_value());
  const auto whole = bytes(kAnswer);
  line.bring({whole.begin(), whole.begin() + 10});
  EXPECT_FALSE(sensor.poll(at_ms(1))->has_value());
  line.bring({whole.begin() + 10, whole.end()});
  EXPECT_TRUE(sensor.poll(at_ms(2))->has_value());
}

TEST(ModbusRangeSensor, tells_each_wrong_answer_and_goes_on) {
  for (const auto& [answer, error] : {std::pair{kOtherUnit, Error::kSensorWrongUnit},
                                      std::pair{kIllegalAddress, Error::kSensorException},
                                      std::pair{kOneRegister, Error::kSensorMalformed},
                                      std::pair{"0104020001FFFF", Error::kSensorBadCrc}}) {
    ScriptedLine line;
    line.answer = bytes(answer);
    RangeSensor sensor({}, line);
    EXPECT_TRUE(sensor.poll(at_ms(0)));
    EXPECT_EQ(test::failure_of(sensor.poll(at_ms(1))), error) << answer;
    line.answer = bytes(kAnswer);
    EXPECT_TRUE(sensor.poll(at_ms(20)));
    EXPECT_TRUE(sensor.poll(at_ms(21))->has_value());
  }
}

TEST(ModbusRangeSensor, keeps_the_code_of_the_last_exception) {
  ScriptedLine line;
  line.answer = bytes(kIllegalAddress);
  RangeSensor sensor({}, line);
  EXPECT_TRUE(sensor.poll(at_ms(0)));
  EXPECT_EQ(test::failure_of(sensor.poll(at_ms(1))), Error::kSensorException);
  EXPECT_EQ(sensor.exception_code(), 2);
}

TEST(ModbusRangeSensor, a_cut_answer_ends_with_the_pause_of_the_line) {
  ScriptedLine line;
  const auto whole = bytes(kAnswer);
  line.answer = {whole.begin(), whole.begin() + 10};
  RangeSensor sensor({}, line);
  EXPECT_TRUE(sensor.poll(at_ms(0)));
  EXPECT_TRUE(sensor.poll(at_ms(1)));
  EXPECT_EQ(test::failure_of(sensor.poll(at_ms(3))), Error::kSensorBadCrc);
}

TEST(ModbusRangeSensor, is_silent_after_the_time_allowed) {
  ScriptedLine line;
  RangeSensor sensor({}, line);
  for (int ms = 0; ms <= 500; ++ms) ASSERT_TRUE(sensor.poll(at_ms(ms)));
  EXPECT_EQ(test::failure_of(sensor.poll(at_ms(501))), Error::kSensorSilent);
  EXPECT_GE(line.written.size(), 4U);
}

TEST(ModbusRangeSensor, is_stale_when_the_sequence_stands_still) {
  ScriptedLine line;
  line.answer = bytes(kAnswer);
  RangeSensor sensor({}, line);
  int stale = 0;
  for (int ms = 0; ms <= 520; ++ms) {
    const auto reading = sensor.poll(at_ms(ms));
    if (!reading && reading.error() == Error::kSensorStale) ++stale;
  }
  EXPECT_EQ(stale, 1);
}

TEST(ModbusRangeSensor, throws_away_what_was_on_the_line_before_the_request) {
  ScriptedLine line;
  line.bring(bytes("FFFFFFFF"));
  line.answer = bytes(kAnswer);
  RangeSensor sensor({}, line);
  EXPECT_TRUE(sensor.poll(at_ms(0)));
  EXPECT_TRUE(sensor.poll(at_ms(1))->has_value());
}

TEST(ModbusRangeSensor, says_when_the_line_is_gone) {
  ScriptedLine line;
  line.down = true;
  RangeSensor sensor({}, line);
  EXPECT_EQ(test::failure_of(sensor.poll(at_ms(0))), Error::kBusDown);
}

}  // namespace
}  // namespace armsig::modbus
