// SPDX-License-Identifier: MIT
// Frames of Modbus TCP, by the examples of its specifications, and points in registers.
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "hal/modbus/number_registers.hpp"
#include "hal/modbus/tcp.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::modbus {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Application Protocol V1.1b3, 6.3: registers 108 to 110 hold 22Bh, 0 and 64h.
constexpr ReadRequest kExample{.unit = 0xFF, .function = 3, .registers = {0x6B, 3}};
const Bytes kAnswer{0x15, 0x01, 0, 0, 0, 9, 0xFF, 3, 6, 0x02, 0x2B, 0, 0, 0, 0x64};

TEST(ModbusTcp, asks_as_the_guide_has_it) {
  const auto bytes = encode_tcp(kExample, 0x1501);
  EXPECT_EQ(Bytes(bytes.begin(), bytes.end()),
            (Bytes{0x15, 0x01, 0, 0, 0, 6, 0xFF, 3, 0, 0x6B, 0, 3}));
}

TEST(ModbusTcp, reads_an_answer) {
  EXPECT_EQ(*tcp_answer_bytes(kAnswer), kAnswer.size());
  EXPECT_EQ(tcp_transaction(kAnswer), 0x1501);
  const auto registers = decode_tcp(kExample, kAnswer);
  ASSERT_TRUE(registers);
  ASSERT_EQ(registers->size(), 3U);
  EXPECT_EQ((*registers)[0], 0x22B);
  EXPECT_EQ((*registers)[1], 0);
  EXPECT_EQ((*registers)[2], 0x64);
}

TEST(ModbusTcp, cannot_tell_the_length_before_the_header_has_come) {
  for (std::size_t count = 0; count < kTcpHeaderBytes; ++count) {
    EXPECT_EQ(*tcp_answer_bytes(std::span(kAnswer).first(count)), 0U) << count;
  }
  EXPECT_EQ(*tcp_answer_bytes(std::span(kAnswer).first(kTcpHeaderBytes)), kAnswer.size());
}

TEST(ModbusTcp, tells_a_header_that_is_none) {
  Bytes other_protocol = kAnswer;
  other_protocol[3] = 1;
  EXPECT_EQ(test::failure_of(tcp_answer_bytes(other_protocol)), Error::kSensorMalformed);
  for (const auto& [high, low] : {std::pair<std::uint8_t, std::uint8_t>{0, 2}, {0, 255}, {1, 0}}) {
    Bytes length = kAnswer;
    length[4] = high;
    length[5] = low;
    EXPECT_EQ(test::failure_of(tcp_answer_bytes(length)), Error::kSensorMalformed) << int{low};
  }
  Bytes longest = kAnswer;
  longest[5] = 254;
  EXPECT_EQ(*tcp_answer_bytes(longest), kMostTcpBytes);
}

TEST(ModbusTcp, names_what_an_answer_lacks) {
  const Bytes exception{0x15, 0x01, 0, 0, 0, 3, 0xFF, 0x83, 2};
  const auto refused = decode_tcp(kExample, exception);
  ASSERT_FALSE(refused);
  EXPECT_EQ(test::failure_of(refused).error, Error::kSensorException);
  EXPECT_EQ(test::failure_of(refused).exception, 2);
  Bytes other = kAnswer;
  other[6] = 1;
  EXPECT_EQ(test::failure_of(decode_tcp(kExample, other)).error, Error::kSensorWrongUnit);
  other = kAnswer;
  other[7] = 4;
  EXPECT_EQ(test::failure_of(decode_tcp(kExample, other)).error, Error::kSensorWrongUnit);
  other = kAnswer;
  other[8] = 4;
  EXPECT_EQ(test::failure_of(decode_tcp(kExample, other)).error, Error::kSensorMalformed);
  EXPECT_EQ(test::failure_of(decode_tcp(kExample, std::span(kAnswer).first(4))).error,
            Error::kSensorMalformed);
}

NumberProfile floats() { return {.metres_a_step = 1e-3, .registers = {10, 12, 14}, .counter = 16}; }

void put(std::vector<std::uint16_t>& registers, std::size_t at, float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  registers[at] = static_cast<std::uint16_t>(bits >> 16);
  registers[at + 1] = static_cast<std::uint16_t>(bits);
}

TEST(NumberRegisters, are_read_by_one_request) {
  NumberProfile profile = floats();
  const auto request = request_of(profile);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->registers.first, 10);
  EXPECT_EQ(request->registers.count, 7);
  profile.counter = 3;
  EXPECT_EQ(request_of(profile)->registers.first, 3);
  EXPECT_EQ(request_of(profile)->registers.count, 13);
}

TEST(NumberRegisters, hold_millimetres_in_floats_and_their_number) {
  const NumberProfile profile = floats();
  std::vector<std::uint16_t> registers(7);
  put(registers, 0, 812.5F);
  put(registers, 2, -31.25F);
  put(registers, 4, 455.0F);
  registers[6] = 65535;
  const auto numbers = numbers_in(profile, *request_of(profile), registers);
  ASSERT_EQ(numbers.metres.size(), 3U);
  EXPECT_DOUBLE_EQ(numbers.metres[0], 0.8125);
  EXPECT_DOUBLE_EQ(numbers.metres[1], -0.03125);
  EXPECT_DOUBLE_EQ(numbers.metres[2], 0.455);
  EXPECT_EQ(numbers.sequence, 65535U);
}

TEST(NumberRegisters, hold_micrometres_in_integers_low_word_first) {
  NumberProfile profile = floats();
  profile.format = Format::kI32;
  profile.high_word_first = false;
  profile.metres_a_step = 1e-6;
  profile.counter.reset();
  profile.update_period = std::chrono::milliseconds(100);
  // 812,500; -31,250; 455,000.
  const std::vector<std::uint16_t> registers{0x65D4, 0x000C, 0x85EE, 0xFFFF, 0xF158, 0x0006};
  const auto numbers = numbers_in(profile, *request_of(profile), registers);
  ASSERT_EQ(numbers.metres.size(), 3U);
  EXPECT_NEAR(numbers.metres[0], 0.8125, 1e-12);
  EXPECT_NEAR(numbers.metres[1], -0.03125, 1e-12);
  EXPECT_NEAR(numbers.metres[2], 0.455, 1e-12);
  EXPECT_FALSE(numbers.sequence);
}

TEST(NumberRegisters, are_refused_where_they_cannot_be) {
  const auto refused = [](void (*change)(NumberProfile&)) {
    NumberProfile profile = floats();
    change(profile);
    const auto request = request_of(profile);
    return !request && test::failure_of(request) == Error::kProfileInvalid;
  };
  EXPECT_FALSE(refused([](NumberProfile&) {}));
  EXPECT_TRUE(refused([](NumberProfile& p) { p.registers.clear(); }));
  EXPECT_TRUE(refused([](NumberProfile& p) { p.unit = 0; }));
  EXPECT_TRUE(refused([](NumberProfile& p) { p.unit = 248; }));
  EXPECT_TRUE(refused([](NumberProfile& p) { p.function = 5; }));
  EXPECT_TRUE(refused([](NumberProfile& p) { p.registers[1] = 11; }));
  EXPECT_TRUE(refused([](NumberProfile& p) { p.counter = 15; }));
  EXPECT_TRUE(refused([](NumberProfile& p) { p.registers[2] = 65535; }));
  EXPECT_TRUE(refused([](NumberProfile& p) { p.registers[2] = 10 + 124; }));
  EXPECT_FALSE(refused([](NumberProfile& p) { p.registers[2] = 10 + 123; }));
  EXPECT_TRUE(refused([](NumberProfile& p) { p.metres_a_step = 0; }));
  EXPECT_TRUE(refused([](NumberProfile& p) { p.metres_a_step = std::nan(""); }));
  EXPECT_TRUE(refused([](NumberProfile& p) { p.counter.reset(); }));
  EXPECT_TRUE(refused([](NumberProfile& p) { p.update_period = std::chrono::milliseconds(1); }));
}

}  // namespace
}  // namespace armsig::modbus
