// SPDX-License-Identifier: MIT
// Every way in which the channels of a sensor on Modbus can be wrong is refused at its place in the
// configuration file.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "firmware/linux/daemon_configuration.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::daemon {
namespace {

// The reference without the grid, with four receivers and `modbus` as given.
std::string with_modbus(const std::string& modbus) {
  std::ifstream file(ARMSIG_REFERENCE);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  text = text.substr(0, text.find("\ngrid:") + 1);
  const std::size_t more = text.find("    - {x_mm: -500,  y_mm: -500,  z_mm: 800}");
  text.erase(more, text.find("  facing:") - more);
  const std::size_t begin = text.find("  modbus:");
  return text.replace(begin, text.find("\nmotion:") - begin, modbus);
}

constexpr const char* kChannels = R"(  modbus:
    device: /dev/ttyUSB0
    baud: 9600
    direction: rts-high
    function: 3
    register: 256
    metres_a_step: 1.0e-3
    speed_of_sound_m_per_s: 340
    offset_mm: 12.5
    valid: [250, 4500]
    invalid: [0, 65535]
    update_period_ms: 150
    answer_timeout_ms: 50
    silent_after_ms: 900
    largest_gap: 2
    air: {unit: 7, register: 258, celsius_a_step: 0.1}
    channels:
      - {unit: 1}
      - {unit: 2, register: 300, format: i32, words: low-first}
      - {unit: 3, offset_mm: -3, valid: [1, 2], invalid: [9]}
      - {unit: 4, function: 4}
)";

struct Changed {
  std::string text;
  int line = 0;
};
Changed change(const std::string& from, const std::string& to) {
  Changed changed{with_modbus(kChannels), 0};
  const std::size_t at = changed.text.find(from, changed.text.find("  modbus:"));
  if (at == std::string::npos) {
    ADD_FAILURE() << from << " is not in the configuration";
    return changed;
  }
  changed.line = 1 + static_cast<int>(std::count(
                         changed.text.begin(), changed.text.begin() + static_cast<long>(at), '\n'));
  changed.text.replace(at, from.size(), to);
  return changed;
}

// `line_of`: what stands in the line that is named; by default what was changed.
void expect_refused(const std::string& from, const std::string& to, const std::string& words,
                    const std::string& line_of = "") {
  const Changed changed = change(from, to);
  const auto read = parse_configuration(changed.text, "cabinet.yaml");
  ASSERT_FALSE(read) << from << " -> " << to << " was accepted";
  const std::string message = tool::render(read.error());
  const int line = line_of.empty() ? changed.line : change(line_of, line_of).line;
  EXPECT_EQ(test::failure_of(read).line, line) << message;
  EXPECT_GT(test::failure_of(read).column, 0) << message;
  EXPECT_FALSE(test::failure_of(read).expected.empty()) << message;
  EXPECT_NE(message.find(words), std::string::npos) << message;
}

linux_hal::RtuRangeSensorConfiguration sensor_of(const std::string& text) {
  const auto read = parse_configuration(text, "cabinet.yaml");
  if (!read) {
    ADD_FAILURE() << tool::render(read.error());
    return {};
  }
  return std::get<linux_hal::RtuRangeSensorConfiguration>(read->sensor);
}

TEST(ChannelConfiguration, is_read_as_it_is_written_with_defaults_for_all_channels) {
  const auto sensor = sensor_of(with_modbus(kChannels));
  EXPECT_EQ(sensor.direction, linux_hal::Direction::kRtsHigh);
  EXPECT_EQ(sensor.freshness.silent_after, std::chrono::milliseconds(900));
  ASSERT_TRUE(sensor.channels);
  const modbus::ChannelProfile& profile = *sensor.channels;
  EXPECT_TRUE(profile.distance);
  EXPECT_FALSE(profile.echo);
  EXPECT_EQ(profile.sound_m_s, 340);
  EXPECT_EQ(profile.update_period, std::chrono::milliseconds(150));
  EXPECT_EQ(profile.largest_gap, 2);
  ASSERT_EQ(profile.channels.size(), 4U);
  const modbus::Channel& first = profile.channels[0];
  EXPECT_EQ(first.field.unit, 1);
  EXPECT_EQ(first.field.function, 3);
  EXPECT_EQ(first.field.first, 256);
  EXPECT_EQ(first.field.format, modbus::Format::kU16);
  EXPECT_EQ(first.field.step, 1e-3);
  EXPECT_EQ(first.offset, 12.5e-3);
  EXPECT_EQ(first.lowest, 250);
  EXPECT_EQ(first.highest, 4500);
  ASSERT_EQ(first.invalid.size(), 2U);
  EXPECT_EQ(first.invalid[1], 65535);
  const modbus::Field& second = profile.channels[1].field;
  EXPECT_EQ(second.first, 300);
  EXPECT_EQ(second.format, modbus::Format::kI32);
  EXPECT_FALSE(second.high_word_first);
  const modbus::Channel& third = profile.channels[2];
  EXPECT_EQ(third.offset, -3e-3);
  EXPECT_EQ(third.highest, 2);
  ASSERT_EQ(third.invalid.size(), 1U);
  EXPECT_EQ(profile.channels[3].field.function, 4);
  ASSERT_TRUE(profile.air);
  EXPECT_EQ(profile.air->unit, 7);
  EXPECT_EQ(profile.air->function, 3);
  EXPECT_EQ(profile.air->format, modbus::Format::kI16);
  EXPECT_EQ(profile.air->step, 0.1);
}

TEST(ChannelConfiguration, takes_times_fixed_air_and_a_counter) {
  std::string text = with_modbus(R"(  modbus:
    device: /dev/ttyUSB0
    format: f32
    seconds_a_step: 1.0e-6
    path: echo
    offset_ms: -0.015
    air: {fixed_c: 21.5}
    counter: {register: 20, format: u32}
    stale_after_ms: 300
    channels: [{register: 0}, {register: 2}, {register: 4}, {register: 6}]
)");
  const auto sensor = sensor_of(text);
  ASSERT_TRUE(sensor.channels);
  EXPECT_FALSE(sensor.channels->distance);
  EXPECT_TRUE(sensor.channels->echo);
  EXPECT_FALSE(sensor.channels->air);
  EXPECT_EQ(sensor.channels->fixed_air_celsius, 21.5);
  ASSERT_TRUE(sensor.channels->counter);
  EXPECT_EQ(sensor.channels->counter->first, 20);
  EXPECT_EQ(sensor.channels->counter->unit, 1);
  EXPECT_EQ(sensor.channels->counter->format, modbus::Format::kU32);
  EXPECT_DOUBLE_EQ(sensor.channels->channels[3].offset, -15e-6);
  EXPECT_EQ(sensor.channels->update_period, hal::Duration{});
  EXPECT_EQ(sensor.freshness.stale_after, std::chrono::milliseconds(300));
  EXPECT_EQ(modbus::requests_of(*sensor.channels)->size(), 2U);
}

TEST(ChannelConfiguration, refuses_another_number_of_channels_than_of_receivers) {
  expect_refused("      - {unit: 4, function: 4}\n", "", "3 channels; expected a list of 4",
                 "- {unit: 1}");
  expect_refused("- {unit: 1}", "- {unit: 1}\n      - {unit: 9}", "5 channels");
  const auto read = parse_configuration(change("channels:", "channels: 3 #").text, "c.yaml");
  EXPECT_FALSE(read);
}

TEST(ChannelConfiguration, refuses_fewer_receivers_than_locate_a_target_and_says_why) {
  std::string text = with_modbus(kChannels);
  const std::size_t second = text.find("    - {x_mm: 1000,  y_mm: -1000, z_mm: 0}");
  text.erase(second, text.find("  facing:") - second);
  const auto read = parse_configuration(text, "cabinet.yaml");
  ASSERT_FALSE(read);
  const std::string message = tool::render(test::failure_of(read));
  EXPECT_NE(message.find("1 receiver; expected 3 at least"), std::string::npos) << message;
  EXPECT_NE(message.find("on a circle"), std::string::npos) << message;
}

TEST(ChannelConfiguration, refuses_keys_of_a_register_map_beside_channels_and_the_reverse) {
  expect_refused("largest_gap: 2", "status: 0", "status is of a register map");
  expect_refused("largest_gap: 2", "celsius_a_step: 0.1", "of a register map");
  std::ifstream file(ARMSIG_REFERENCE);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  text.replace(text.find("    status: 0"), 13, "    metres_a_step: 0.1 #");
  const auto read = parse_configuration(text, "cabinet.yaml");
  ASSERT_FALSE(read);
  EXPECT_NE(tool::render(test::failure_of(read)).find("metres_a_step is of channels"),
            std::string::npos);
}

TEST(ChannelConfiguration, refuses_formats_words_and_directions_that_it_does_not_know) {
  expect_refused("format: i32", "format: float", "u16, i16, u32, i32 or f32");
  expect_refused("words: low-first", "words: little", "high-first or low-first");
  expect_refused("direction: rts-high", "direction: rts", "automatic, rts-high or rts-low");
  expect_refused("speed_of_sound_m_per_s: 340", "speed_of_sound_m_per_s: 340\n    path: round",
                 "one-way or echo", "offset_mm: 12.5");
}

TEST(ChannelConfiguration, refuses_units_functions_and_registers_that_cannot_be) {
  expect_refused("{unit: 1}", "{unit: 0}", "an integer from 1 to 247");
  expect_refused("{unit: 1}", "{unit: 248}", "an integer from 1 to 247");
  expect_refused("function: 4", "function: 6", "an integer from 3 to 4");
  expect_refused("register: 300", "register: 65536", "an integer from 0 to 65535");
  expect_refused("register: 300", "register: 65535", "a register below 65535");
  expect_refused("unit: 7, register: 258", "unit: 7, register: 65535, format: f32",
                 "a register below 65535");
  expect_refused("largest_gap: 2", "largest_gap: 126", "an integer from 0 to 125");
}

TEST(ChannelConfiguration, refuses_a_channel_or_air_without_a_register) {
  std::string text = change("    register: 256\n", "").text;
  const auto read = parse_configuration(text, "cabinet.yaml");
  ASSERT_FALSE(read);
  EXPECT_NE(tool::render(test::failure_of(read)).find("channel 1 has no key \"register\""),
            std::string::npos);
  expect_refused("unit: 7, register: 258", "unit: 7", "air has no key \"register\"");
  expect_refused(", celsius_a_step: 0.1}", "}", "air has no key \"celsius_a_step\"");
  expect_refused("largest_gap: 2", "counter: {unit: 1}", "counter has no key \"register\"");
}

TEST(ChannelConfiguration, refuses_two_numbers_in_one_register) {
  expect_refused("{unit: 2, register: 300", "{unit: 1, register: 255",
                 "channel 2 and channel 1 are one register: unit 1, function 3, 255");
  expect_refused("unit: 7, register: 258", "unit: 1, register: 256",
                 "air and channel 1 are one register");
  expect_refused("largest_gap: 2", "counter: {unit: 3, register: 256}",
                 "counter and channel 3 are one register");
  std::string text = change("largest_gap: 2", "counter: {unit: 7, register: 258}").text;
  text.replace(text.find("    update_period_ms: 150"), 25, "    largest_gap: 1       #");
  const auto read = parse_configuration(text, "cabinet.yaml");
  ASSERT_FALSE(read);
  EXPECT_NE(tool::render(test::failure_of(read)).find("registers of their own"), std::string::npos);
}

TEST(ChannelConfiguration, refuses_what_does_not_say_what_it_measures) {
  expect_refused("metres_a_step: 1.0e-3", "poll_period_ms: 20",
                 "nothing says what the channels measure", "device:");
  expect_refused("metres_a_step: 1.0e-3", "metres_a_step: 1.0e-3\n    seconds_a_step: 1.0e-6",
                 "distances and times");
  expect_refused("metres_a_step: 1.0e-3", "seconds_a_step: 1.0e-6", "knows no speed of sound");
  expect_refused("speed_of_sound_m_per_s: 340", "compensated: no", "how the sensor computes",
                 "metres_a_step");
  expect_refused("speed_of_sound_m_per_s: 340", "speed_of_sound_m_per_s: 340\n    compensated: yes",
                 "no fixed speed of sound", "metres_a_step");
  expect_refused("speed_of_sound_m_per_s: 340", "compensated: maybe", "yes or no");
}

TEST(ChannelConfiguration, refuses_steps_speeds_and_offsets_of_another_unit) {
  expect_refused("metres_a_step: 1.0e-3", "metres_a_step: 1", "millimetres as metres?");
  expect_refused("metres_a_step: 1.0e-3", "metres_a_step: 0", "above 0");
  expect_refused("speed_of_sound_m_per_s: 340", "speed_of_sound_m_per_s: 34", "from 300 to 380");
  expect_refused("speed_of_sound_m_per_s: 340", "speed_of_sound_mm_per_s: 340", "from 300 to 380");
  expect_refused("offset_mm: 12.5", "offset_m: 12.5", "millimetres as metres?");
  expect_refused("offset_mm: 12.5", "offset_ms: 12.5", "offset_ms of distances");
  expect_refused("{unit: 1}", "{unit: 1, offset_ms: 1}", "unknown key");
  expect_refused("celsius_a_step: 0.1", "celsius_a_step: 100", "kelvins");
  expect_refused("celsius_a_step: 0.1", "celsius_a_step: -1", "above 0");
}

TEST(ChannelConfiguration, takes_metres_as_they_are_where_every_channel_has_a_point) {
  std::string text = with_modbus(R"(  modbus:
    device: /dev/ttyUSB0
    format: f32
    metres_a_step: 1
    compensated: yes
    update_period_ms: 100
    air: {fixed_c: 21.5}
    channels: [{register: 0}, {register: 2}, {register: 4}, {register: 6}]
)");
  EXPECT_TRUE(sensor_of(text).channels);
  text.replace(text.find("{register: 6}"), 13, "{register: 6, format: u16}");
  EXPECT_FALSE(parse_configuration(text, "cabinet.yaml"));
}

TEST(ChannelConfiguration, refuses_values_that_leave_nothing_to_hear) {
  expect_refused("valid: [250, 4500]", "valid: [4500, 250]", "the lowest value first");
  expect_refused("valid: [250, 4500]", "valid: [250]", "a list of 2 items");
  expect_refused("invalid: [0, 65535]", "invalid: []", "a list of 1 to 4 items");
  expect_refused("invalid: [0, 65535]", "invalid: [1, 2, 3, 4, 5]", "a list of 1 to 4 items");
  expect_refused("invalid: [0, 65535]", "invalid: [0xFFFF]", "a number");
}

TEST(ChannelConfiguration, refuses_air_that_is_missing_or_both_fixed_and_measured) {
  expect_refused("    air: {unit: 7, register: 258, celsius_a_step: 0.1}\n", "",
                 "has no key \"air\"", "device:");
  const std::string air = "{unit: 7, register: 258, celsius_a_step: 0.1}";
  expect_refused(air, "{fixed_c: 20, register: 258}", "both fixed and measured");
  expect_refused(air, "{fixed_c: 60}", "from 0 to 45");
  expect_refused(air, "{fixed_c: warm}", "a number");
  expect_refused(air, "{fixed: 20}", "fixed_c");
  expect_refused(air, "20", "a map of keys and values");
}

TEST(ChannelConfiguration, refuses_readings_that_nothing_says_when_they_are_new) {
  expect_refused("update_period_ms: 150", "poll_period_ms: 150",
                 "nothing says when a reading is new", "device:");
  expect_refused("update_period_ms: 150", "update_period_ms: 150\n    counter: {register: 9}",
                 "the counter says when a reading is new");
  expect_refused("largest_gap: 2", "counter: {register: 9, format: f32}", "u16, i16, u32 or i32");
}

TEST(ChannelConfiguration, refuses_a_sensor_that_could_never_be_heard) {
  expect_refused("update_period_ms: 150", "update_period_ms: 501",
                 "reading_timeout has to last for two readings");
  expect_refused("silent_after_ms: 900", "silent_after_ms: 290", "two readings");
  expect_refused("largest_gap: 2", "stale_after_ms: 900", "no reading is stale");
  // 150 ms and five units, the thermometer's among them, of 50 ms.
  expect_refused("silent_after_ms: 900", "silent_after_ms: 399", "0.4 s at least: a round of 5");
  EXPECT_TRUE(sensor_of(change("silent_after_ms: 900", "silent_after_ms: 400").text).channels);
  expect_refused("answer_timeout_ms: 50", "answer_timeout_ms: 200", "a round of 5 units",
                 "silent_after_ms");
  // By the default of silent_after, the list is named.
  std::string text = change("    silent_after_ms: 900\n", "").text;
  text.replace(text.find("answer_timeout_ms: 50"), 21, "answer_timeout_ms: 80");
  const auto read = parse_configuration(text, "cabinet.yaml");
  ASSERT_FALSE(read);
  EXPECT_NE(tool::render(test::failure_of(read)).find("0.55 s at least"), std::string::npos);
}

}  // namespace
}  // namespace armsig::daemon
