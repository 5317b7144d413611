// SPDX-License-Identifier: MIT
// Golden registers come from a Python program (struct), not from the code under test.
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/modbus/channels.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::modbus {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Channel at(std::uint16_t first, Format format = Format::kU16, std::uint8_t unit = 1,
           std::uint8_t function = 4) {
  return {.field = {.unit = unit, .function = function, .first = first, .format = format}};
}

ChannelProfile with(const FixedVector<Channel, kMaxReceivers>& channels) {
  return {.channels = channels};
}

// "1/4: 5+2, 2/4: 5+1" for the requests of a profile.
std::string requests_in_words(const ChannelProfile& profile) {
  const auto requests = requests_of(profile);
  if (!requests) return std::string(describe(requests.error()));
  std::string words;
  for (const ReadRequest& request : *requests) {
    words += (words.empty() ? "" : ", ") + std::to_string(request.unit) + "/" +
             std::to_string(request.function) + ": " + std::to_string(request.registers.first) +
             "+" + std::to_string(request.registers.count);
  }
  return words;
}

double number(Format format, bool high_word_first, const std::vector<std::uint16_t>& registers) {
  const Field field{.first = 7, .format = format, .high_word_first = high_word_first};
  const ReadRequest request{1, 4, {7, static_cast<std::uint16_t>(registers.size())}};
  return number_in(field, request, registers);
}

TEST(ModbusChannels, are_numbers_of_five_formats_in_either_order_of_words) {
  EXPECT_EQ(number(Format::kU16, true, {0xFFFE}), 65534);
  EXPECT_EQ(number(Format::kI16, true, {0xFFFE}), -2);
  EXPECT_EQ(number(Format::kU32, true, {0xFFFE, 0x0001}), 4294836225.0);
  EXPECT_EQ(number(Format::kU32, false, {0x0001, 0xFFFE}), 4294836225.0);
  EXPECT_EQ(number(Format::kI32, true, {0xFFFE, 0x0001}), -131071);
  EXPECT_EQ(number(Format::kI32, false, {0x0001, 0xFFFE}), -131071);
  EXPECT_EQ(number(Format::kF32, true, {0x449A, 0x5000}), 1234.5);
  EXPECT_EQ(number(Format::kF32, false, {0x5000, 0x449A}), 1234.5);
  EXPECT_TRUE(std::isnan(number(Format::kF32, true, {0x7FC0, 0})));
  EXPECT_EQ(number(Format::kF32, true, {0xFF80, 0}), -kInfinity);
}

TEST(ModbusChannels, stand_where_the_request_has_them) {
  const ReadRequest request{3, 3, {100, 4}};
  const std::vector<std::uint16_t> registers{1, 2, 3, 4};
  const Field field{.unit = 3, .function = 3, .first = 102, .format = Format::kU32};
  EXPECT_EQ(number_in(field, request, registers), 3 * 65536 + 4);
  EXPECT_TRUE(covers(request, field));
  for (const Field& other :
       {Field{.unit = 2, .function = 3, .first = 102}, Field{.unit = 3, .first = 102},
        Field{.unit = 3, .function = 3, .first = 99},
        Field{.unit = 3, .function = 3, .first = 103, .format = Format::kF32}}) {
    EXPECT_FALSE(covers(request, other)) << other.first;
  }
}

TEST(ModbusChannels, of_one_unit_and_function_come_in_one_request_where_they_are_near) {
  EXPECT_EQ(requests_in_words(with({at(5)})), "1/4: 5+1");
  EXPECT_EQ(requests_in_words(with({at(9), at(5, Format::kU32)})), "1/4: 5+5");
  EXPECT_EQ(requests_in_words(with({at(5), at(5, Format::kU16, 2)})), "1/4: 5+1, 2/4: 5+1");
  EXPECT_EQ(requests_in_words(with({at(5), at(5, Format::kU16, 1, 3)})), "1/3: 5+1, 1/4: 5+1");
}

TEST(ModbusChannels, leave_a_gap_of_as_many_registers_as_allowed_and_no_more) {
  ChannelProfile profile = with({at(10), at(19)});
  EXPECT_EQ(requests_in_words(profile), "1/4: 10+10") << "eight between them";
  profile = with({at(10), at(20)});
  EXPECT_EQ(requests_in_words(profile), "1/4: 10+1, 1/4: 20+1");
  profile = with({at(10), at(11), at(13)});
  profile.largest_gap = 0;
  EXPECT_EQ(requests_in_words(profile), "1/4: 10+2, 1/4: 13+1");
}

TEST(ModbusChannels, take_125_registers_a_request_and_end_at_65535) {
  ChannelProfile profile = with({at(0), at(124)});
  profile.largest_gap = 200;
  EXPECT_EQ(requests_in_words(profile), "1/4: 0+125");
  profile.channels[1] = at(124, Format::kU32);
  EXPECT_EQ(requests_in_words(profile), "1/4: 0+1, 1/4: 124+2");
  EXPECT_EQ(requests_in_words(with({at(65535)})), "1/4: 65535+1");
  EXPECT_EQ(requests_in_words(with({at(65534, Format::kF32)})), "1/4: 65534+2");
  EXPECT_EQ(test::failure_of(requests_of(with({at(65535, Format::kF32)}))), Error::kProfileInvalid);
}

TEST(ModbusChannels, are_read_with_air_and_counter_in_eighteen_requests_at_most) {
  ChannelProfile profile;
  for (std::uint8_t unit = 1; unit <= kMaxReceivers; ++unit) {
    profile.channels.push_back(at(5, Format::kU16, unit));
  }
  profile.air = Field{.unit = 100};
  profile.counter = Field{.unit = 101};
  const auto requests = requests_of(profile);
  ASSERT_TRUE(requests);
  EXPECT_EQ(requests->size(), 18U);
  profile.air->unit = 1;
  profile.air->first = 6;
  EXPECT_EQ(requests_of(profile)->size(), 17U);
}

TEST(ModbusChannels, refuse_what_contradicts_itself) {
  EXPECT_FALSE(requests_of(ChannelProfile{})) << "no channel";
  EXPECT_FALSE(requests_of(with({at(5), at(5)}))) << "one register for two receivers";
  EXPECT_FALSE(requests_of(with({at(5, Format::kU32), at(6)}))) << "half of one";
  EXPECT_FALSE(requests_of(with({at(5, Format::kU16, 0)})));
  EXPECT_FALSE(requests_of(with({at(5, Format::kU16, 248)})));
  EXPECT_FALSE(requests_of(with({at(5, Format::kU16, 1, 2)})));
  const auto refused = [](auto&& change) {
    ChannelProfile profile = with({at(5)});
    change(profile);
    return !requests_of(profile);
  };
  for (const double bad : {0.0, -1.0, kNaN, kInfinity}) {
    EXPECT_TRUE(refused([&](ChannelProfile& p) { p.channels[0].field.step = bad; })) << bad;
  }
  for (const double bad : {-1.0, kNaN, kInfinity}) {
    EXPECT_TRUE(refused([&](ChannelProfile& p) { p.sound_m_s = bad; })) << bad;
  }
  EXPECT_TRUE(refused([](ChannelProfile& p) { p.channels[0].offset = kNaN; }));
  EXPECT_TRUE(refused([](ChannelProfile& p) { p.channels[0].lowest = kNaN; }));
  EXPECT_TRUE(refused([](ChannelProfile& p) { p.fixed_air_celsius = kNaN; }));
  EXPECT_TRUE(refused([](ChannelProfile& p) { p.update_period = hal::Duration(-1); }));
  EXPECT_TRUE(refused([](ChannelProfile& p) { p.air = Field{.unit = 0}; }));
  EXPECT_TRUE(refused([](ChannelProfile& p) { p.air = Field{.first = 5}; })) << "a channel's";
  EXPECT_TRUE(refused([](ChannelProfile& p) {
    p.counter = Field{.first = 7, .format = Format::kF32};
  })) << "a counter with a fraction";
  EXPECT_FALSE(refused([](ChannelProfile& p) { p.counter = Field{.first = 7}; }));
}

TEST(ModbusChannels, are_times_of_flight_or_distances_by_the_speed_that_the_sensor_computes_by) {
  Channel channel = at(0);
  channel.field.step = 1e-6;
  ChannelProfile times = with({channel});
  EXPECT_DOUBLE_EQ(reading_of(times, channel, 5831, kNaN).flight_s, 5831e-6);
  times.echo = true;
  EXPECT_DOUBLE_EQ(reading_of(times, channel, 5831, kNaN).flight_s, 2915.5e-6);
  channel.offset = -15.5e-6;
  EXPECT_DOUBLE_EQ(reading_of(times, channel, 5831, kNaN).flight_s, 2900e-6) << "of one direction";

  channel = at(0);
  channel.field.step = 1e-3;
  ChannelProfile distances{.channels = {channel}, .distance = true, .sound_m_s = 340};
  EXPECT_EQ(speed_of(distances, 35), 340) << "whatever the air is";
  EXPECT_DOUBLE_EQ(reading_of(distances, channel, 850, 340).flight_s, 0.0025);
  channel.offset = 0.17;
  EXPECT_DOUBLE_EQ(reading_of(distances, channel, 850, 340).flight_s, 0.003);
  distances.sound_m_s = 0;
  EXPECT_NEAR(speed_of(distances, 20), 343.2146, 1e-4) << "331.3 sqrt(1 + 20 / 273.15)";
}

TEST(ModbusChannels, in_air_below_absolute_zero_hear_nothing) {
  Channel channel = at(0);
  ChannelProfile profile{.channels = {channel}, .distance = true};
  EXPECT_FALSE(reading_of(profile, channel, 1, speed_of(profile, -300)).valid);
}

TEST(ModbusChannels, hear_nothing_in_what_is_no_range) {
  Channel channel = at(0);
  channel.lowest = 100;
  channel.highest = 1500;
  channel.invalid = {777, 1000};
  const ChannelProfile profile = with({channel});
  for (const double heard : {100.0, 776.0, 778.0, 1500.0}) {
    EXPECT_TRUE(reading_of(profile, channel, heard, 340).valid) << heard;
  }
  for (const double nothing :
       {99.0, 1501.0, 777.0, 1000.0, 0.0, -5.0, kNaN, kInfinity, -kInfinity}) {
    EXPECT_FALSE(reading_of(profile, channel, nothing, 340).valid) << nothing;
    EXPECT_EQ(reading_of(profile, channel, nothing, 340).flight_s, 0) << nothing;
  }
}

TEST(ModbusChannels, without_bounds_hear_nothing_at_zero_and_below) {
  Channel channel = at(0, Format::kF32);
  const ChannelProfile profile = with({channel});
  for (const double nothing : {0.0, -0.0, -1e-30, kNaN, kInfinity}) {
    EXPECT_FALSE(reading_of(profile, channel, nothing, 340).valid) << nothing;
  }
  EXPECT_TRUE(reading_of(profile, channel, 1e-30, 340).valid);
  channel.offset = -1;
  EXPECT_FALSE(reading_of(profile, channel, 1, 340).valid) << "nor where an offset leaves no way";
  channel.field.step = 1e300;
  channel.offset = 0;
  EXPECT_FALSE(reading_of(profile, channel, 1e30, 340).valid) << "nor beyond every number";
}

}  // namespace
}  // namespace armsig::modbus
