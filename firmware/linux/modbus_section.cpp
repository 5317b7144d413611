// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "firmware/controller/plausibility.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/linux/sensor_parts.hpp"

namespace armsig::daemon {
namespace {

using controller::plausible::kAnswerTimeout;
using controller::plausible::kCelsiusAStep;
using controller::plausible::kPollPeriod;
using controller::plausible::kSecondsAStep;
using linux_hal::Direction;
using tool::add_names;
using tool::Dimension;
using tool::problem_at;
using tool::Read;
using tool::YamlMap;
using tool::YamlNode;
using Names = std::vector<std::string>;

Read<char> read_parity(const YamlMap& map) {
  const YamlNode* node = map.find("parity");
  if (node == nullptr || node->text == "even") return 'E';
  if (node->text == "odd") return 'O';
  if (node->text == "none") return 'N';
  return problem_at(*node, "parity: " + tool::in_quotes(node->text), "even, odd or none");
}

Read<Direction> read_direction(const YamlMap& map) {
  const YamlNode* node = map.find("direction");
  if (node == nullptr || node->text == "automatic") return Direction::kAutomatic;
  if (node->text == "rts-high") return Direction::kRtsHigh;
  if (node->text == "rts-low") return Direction::kRtsLow;
  return problem_at(*node, "direction: " + tool::in_quotes(node->text),
                    "automatic, rts-high or rts-low");
}

// How the sensor is wired and asked.
void read_line(Settings& settings, linux_hal::RtuRangeSensorConfiguration& sensor) {
  settings.integer("baud", 1200, 921'600, sensor.baud)
      .integer("stop_bits", 1, 2, sensor.stop_bits)
      .time("poll_period", sensor.poll_period)
      .time("answer_timeout", sensor.answer_timeout);
}

// Where in its registers is what.
void read_profile(Settings& settings, modbus::Profile& profile) {
  constexpr int kLargestUnit = 247;
  settings.integer("unit", 1, kLargestUnit, profile.unit)
      .integer("function", 3, 4, profile.function)
      .integer("status", 0, kLargestRegister, profile.status)
      .integer("sequence", 0, kLargestRegister, profile.sequence)
      .integer("air_temperature", 0, kLargestRegister, profile.air_temperature)
      .share("celsius_a_step", profile.celsius_a_step)
      .integer("receiver_count", 0, kLargestRegister, profile.receiver_count)
      .integer("first_flight", 0, kLargestRegister, profile.first_flight)
      .integer("flight_stride", 2, kLargestRegister, profile.flight_stride)
      .share("seconds_a_step", profile.seconds_a_step);
}

void set_bounds(Settings& settings, const modbus::Profile& profile) {
  settings.bound("celsius_a_step", std::nullopt, profile.celsius_a_step, kCelsiusAStep)
      .bound("seconds_a_step", std::nullopt, profile.seconds_a_step, kSecondsAStep);
}

// Of the line, and of what is read on it either way.
Names common_names() {
  Names names{"device", "baud",     "parity", "stop_bits",      "direction",
              "unit",   "function", "path",   "seconds_a_step", "words"};
  for (const char* time : {"poll_period", "answer_timeout", "silent_after", "stale_after"}) {
    add_names(names, time, Dimension::kTime);
  }
  return names;
}

Names map_names() {
  return {"status",         "sequence",     "air_temperature", "celsius_a_step",
          "receiver_count", "first_flight", "flight_stride"};
}

Names channel_names() {
  Names names{"channels",      "register",    "format", "valid",   "invalid",
              "metres_a_step", "compensated", "air",    "counter", "largest_gap"};
  add_names(names, "update_period", Dimension::kTime);
  add_names(names, "speed_of_sound", Dimension::kSpeed);
  add_names(names, "offset", Dimension::kLength);
  add_names(names, "offset", Dimension::kTime);
  return names;
}

// A sensor has either a register map or channels; a key of the other kind is named as such.
Read<YamlMap> open_modbus(const YamlNode& node) {
  const bool channels = node.find("channels") != nullptr;
  const Names others = channels ? map_names() : channel_names();
  for (const YamlNode& key : node.keys) {
    if (std::ranges::find(others, key.text) == others.end()) continue;
    return problem_at(
        key, fmt::format("{} is of {}", key.text, channels ? "a register map" : "channels"),
        channels ? "no such key beside channels" : "channels, a list with one for each receiver");
  }
  Names known = common_names();
  const Names own = channels ? channel_names() : map_names();
  known.insert(known.end(), own.begin(), own.end());
  return YamlMap::open(node, "modbus", known);
}

Read<void> read_map(const YamlMap& map, std::size_t receivers,
                    linux_hal::RtuRangeSensorConfiguration& sensor) {
  modbus::Profile& profile = sensor.profile;
  Settings settings(map);
  read_profile(settings, profile);
  set_bounds(settings, profile);
  read_freshness(settings, sensor.poll_period, true, sensor.freshness);
  bound_period(settings, "poll_period", sensor.poll_period, sensor.freshness);
  if (auto done = settings.done(); !done) return done;
  if (auto order = read_word_order(map, profile.high_word_first); !order) return order;
  if (auto path = read_path(map, profile.echo); !path) return path;
  profile.receivers = receivers;
  if (const auto registers = modbus::registers_of(profile); !registers) {
    return problem_at(
        map.node(), std::string(describe(registers.error())),
        fmt::format("at most {} registers from the first to the last", modbus::kMaxRegisters));
  }
  return {};
}

constexpr std::string_view kNeverHeard =
    "a sensor that is given less time than two readings take is never heard";

}  // namespace

Read<void> read_path(const YamlMap& map, bool& echo) {
  const YamlNode* node = map.find("path");
  if (node == nullptr) return {};
  if (node->text != "one-way" && node->text != "echo") {
    return problem_at(*node, "path: " + tool::in_quotes(node->text), "one-way or echo");
  }
  echo = node->text == "echo";
  return {};
}

Read<void> read_word_order(const YamlMap& map, bool& high_word_first) {
  const YamlNode* words = map.find("words");
  if (words == nullptr) return {};
  if (words->text != "high-first" && words->text != "low-first") {
    return problem_at(*words, "words: " + tool::in_quotes(words->text), "high-first or low-first");
  }
  high_word_first = words->text == "high-first";
  return {};
}

void bound_period(Settings& settings, std::string_view name, hal::Duration period,
                  const hal::FreshnessLimits& freshness) {
  const double least_s = hal::seconds(std::min(freshness.silent_after, freshness.stale_after));
  settings.bound(name, Dimension::kTime, hal::seconds(period), {0, least_s / 2, kNeverHeard});
}

void read_freshness(Settings& settings, hal::Duration period, bool counts,
                    hal::FreshnessLimits& freshness) {
  constexpr double kDay_s = 86'400;
  const controller::Bounds patience{2 * hal::seconds(period), kDay_s, kNeverHeard};
  settings.time("silent_after", freshness.silent_after)
      .bound("silent_after", Dimension::kTime, hal::seconds(freshness.silent_after), patience);
  if (counts) {
    settings.time("stale_after", freshness.stale_after)
        .bound("stale_after", Dimension::kTime, hal::seconds(freshness.stale_after), patience);
  } else {
    freshness.stale_after = freshness.silent_after;
  }
}

Read<void> read_modbus(const YamlNode& node, DaemonConfiguration& c) {
  ARMSIG_TRY(map, open_modbus(node));
  linux_hal::RtuRangeSensorConfiguration sensor;
  ARMSIG_TRY(device, map.text("device"));
  ARMSIG_TRY(parity, read_parity(map));
  ARMSIG_TRY(direction, read_direction(map));
  sensor.device = device;
  sensor.parity = parity;
  sensor.direction = direction;
  Settings settings(map);
  read_line(settings, sensor);
  settings.bound("poll_period", Dimension::kTime, hal::seconds(sensor.poll_period), kPollPeriod)
      .bound("answer_timeout", Dimension::kTime, hal::seconds(sensor.answer_timeout),
             kAnswerTimeout);
  if (auto done = settings.done(); !done) return done;
  const controller::Sensor& array = c.controller.sensor;
  auto read = map.find("channels") != nullptr ? read_channels(map, array, sensor)
                                              : read_map(map, array.receivers.p_S.size(), sensor);
  if (!read) return read;
  c.sensor = sensor;
  return {};
}

}  // namespace armsig::daemon
