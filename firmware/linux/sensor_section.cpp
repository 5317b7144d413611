// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/base/pose.hpp"
#include "firmware/controller/plausibility.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/yaml_map.hpp"
#include "firmware/linux/sections.hpp"
#include "firmware/linux/settings.hpp"

namespace armsig::daemon {
namespace {

using controller::plausible::kAnswerTimeout;
using controller::plausible::kCelsiusAStep;
using controller::plausible::kEmitter;
using controller::plausible::kPollPeriod;
using controller::plausible::kSecondsAStep;
using tool::add_names;
using tool::Dimension;
using tool::problem_at;
using tool::Read;
using tool::YamlMap;
using tool::YamlNode;

constexpr double kKelvin = 1;

Read<Vector3> read_point(const YamlNode& node, const std::string& name) {
  std::vector<std::string> known;
  for (const char* axis : {"x", "y", "z"}) add_names(known, axis, Dimension::kLength);
  ARMSIG_TRY(map, YamlMap::open(node, name, known));
  ARMSIG_TRY(x_m, map.quantity("x", Dimension::kLength));
  ARMSIG_TRY(y_m, map.quantity("y", Dimension::kLength));
  ARMSIG_TRY(z_m, map.quantity("z", Dimension::kLength));
  return Vector3(x_m, y_m, z_m);
}

Read<void> read_path(const YamlMap& map, bool& echo) {
  const YamlNode* node = map.find("path");
  if (node == nullptr) return {};
  if (node->text != "one-way" && node->text != "echo") {
    return problem_at(*node, "path: " + tool::in_quotes(node->text), "one-way or echo");
  }
  echo = node->text == "echo";
  return {};
}

// `period_name`: of the setting that says how often there is a reading, and `period` is.
void read_freshness(Settings& settings, std::string_view period_name, hal::Duration period,
                    hal::FreshnessLimits& freshness) {
  constexpr std::string_view kReason =
      "a sensor that is given less time than two readings take is never heard";
  constexpr double kDay_s = 86'400;
  const controller::Bounds patience{2 * hal::seconds(period), kDay_s, kReason};
  settings.time("silent_after", freshness.silent_after)
      .time("stale_after", freshness.stale_after)
      .bound("silent_after", Dimension::kTime, hal::seconds(freshness.silent_after), patience)
      .bound("stale_after", Dimension::kTime, hal::seconds(freshness.stale_after), patience);
  const double least_s = hal::seconds(std::min(freshness.silent_after, freshness.stale_after));
  settings.bound(period_name, Dimension::kTime, hal::seconds(period), {0, least_s / 2, kReason});
}

Read<char> read_parity(const YamlMap& map) {
  const YamlNode* node = map.find("parity");
  if (node == nullptr || node->text == "even") return 'E';
  if (node->text == "odd") return 'O';
  if (node->text == "none") return 'N';
  return problem_at(*node, "parity: " + tool::in_quotes(node->text), "even, odd or none");
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
  constexpr int kLargestRegister = 0xFFFF;
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

void set_bounds(Settings& settings, const linux_hal::RtuRangeSensorConfiguration& sensor) {
  settings.bound("poll_period", Dimension::kTime, hal::seconds(sensor.poll_period), kPollPeriod)
      .bound("answer_timeout", Dimension::kTime, hal::seconds(sensor.answer_timeout),
             kAnswerTimeout)
      .bound("celsius_a_step", std::nullopt, sensor.profile.celsius_a_step, kCelsiusAStep)
      .bound("seconds_a_step", std::nullopt, sensor.profile.seconds_a_step, kSecondsAStep);
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

Read<YamlMap> open_modbus(const YamlNode& node) {
  std::vector<std::string> known{
      "device",   "baud",           "parity",       "stop_bits",       "unit",
      "function", "status",         "sequence",     "air_temperature", "celsius_a_step",
      "path",     "receiver_count", "first_flight", "flight_stride",   "seconds_a_step",
      "words"};
  for (const char* time : {"poll_period", "answer_timeout", "silent_after", "stale_after"}) {
    add_names(known, time, Dimension::kTime);
  }
  return YamlMap::open(node, "modbus", known);
}

Read<void> read_modbus(const YamlNode& node, DaemonConfiguration& c) {
  ARMSIG_TRY(map, open_modbus(node));
  linux_hal::RtuRangeSensorConfiguration sensor;
  modbus::Profile& profile = sensor.profile;
  ARMSIG_TRY(device, map.text("device"));
  ARMSIG_TRY(parity, read_parity(map));
  sensor.device = device;
  sensor.parity = parity;
  Settings settings(map);
  read_line(settings, sensor);
  read_profile(settings, profile);
  set_bounds(settings, sensor);
  read_freshness(settings, "poll_period", sensor.poll_period, sensor.freshness);
  if (auto done = settings.done(); !done) return done;
  if (auto order = read_word_order(map, profile.high_word_first); !order) return order;
  if (auto path = read_path(map, profile.echo); !path) return path;
  profile.receivers = c.controller.sensor.receivers.p_S.size();
  if (const auto registers = modbus::registers_of(profile); !registers) {
    return problem_at(
        node, std::string(describe(registers.error())),
        fmt::format("at most {} registers from the first to the last", modbus::kMaxRegisters));
  }
  c.sensor = sensor;
  return {};
}

Read<void> read_can(const YamlNode& node, DaemonConfiguration& c) {
  std::vector<std::string> known{"node", "path"};
  for (const char* time : {"reading_period", "silent_after", "stale_after"}) {
    add_names(known, time, Dimension::kTime);
  }
  ARMSIG_TRY(map, YamlMap::open(node, "can", known));
  canopen::RangeNodeConfiguration sensor;
  ARMSIG_TRY(number, map.integer("node", 1, canopen::kLargestNode));
  sensor.node = static_cast<canopen::NodeId>(number);
  sensor.receivers = c.controller.sensor.receivers.p_S.size();
  hal::Duration period = std::chrono::milliseconds(20);
  Settings settings(map);
  settings.time("reading_period", period);
  read_freshness(settings, "reading_period", period, sensor.freshness);
  if (auto done = settings.done(); !done) return done;
  if (auto path = read_path(map, sensor.echo); !path) return path;
  if (!canopen::check(sensor)) {
    return problem_at(node, fmt::format("{} receivers on CAN", sensor.receivers),
                      fmt::format("at most {}", canopen::kMaxCanReceivers));
  }
  c.drives.other_nodes.push_back(sensor.node);
  for (const canopen::PeriodicFrame& frame : canopen::traffic(sensor, period)) {
    c.drives.other_traffic.push_back(frame);
  }
  c.sensor = sensor;
  return {};
}

Read<void> read_array(const YamlMap& map, DaemonConfiguration& c) {
  controller::Sensor& sensor = c.controller.sensor;
  ARMSIG_TRY(node, map.require("receivers"));
  ARMSIG_TRY(list, tool::read_list(*node, "receivers", 3, kMaxReceivers));
  for (const YamlNode& item : *list) {
    ARMSIG_TRY(p_S, read_point(item, fmt::format("receiver {}", sensor.receivers.p_S.size() + 1)));
    sensor.receivers.p_S.push_back(p_S);
  }
  ARMSIG_TRY(sigma, map.require_quantity("range_sigma", Dimension::kLength));
  (void)sigma;
  Settings settings(map);
  settings.quantity("range_sigma", Dimension::kLength, sensor.receivers.range_sigma_m)
      .share("largest_air_step_k", sensor.largest_air_step_kelvin)
      .time("reading_timeout", sensor.reading_timeout);
  if (auto done = settings.done(); !done) return done;
  if (const YamlNode* facing = map.find("facing")) {
    ARMSIG_TRY(facing_S, tool::read_vector3(*facing, "facing"));
    sensor.receivers.facing_S = facing_S;
  }
  if (const YamlNode* air = map.find("air_c")) {
    ARMSIG_TRY(bounds, tool::read_numbers(*air, "air_c", 2));
    if (!(bounds[0] + kKelvin <= bounds[1])) {
      return problem_at(*air, fmt::format("air_c: {} to {}", bounds[0], bounds[1]),
                        "the lowest plausible temperature first, then the highest");
    }
    sensor.lowest_air_celsius = bounds[0];
    sensor.highest_air_celsius = bounds[1];
  }
  if (const auto array = measurement::check(sensor.receivers); !array) {
    return problem_at(*node, std::string(describe(array.error())),
                      "receivers, and where they need it `facing`, that tell where a target is");
  }
  return {};
}

}  // namespace

Read<void> read_sensor(const YamlNode& node, DaemonConfiguration& c) {
  std::vector<std::string> known{"receivers", "facing", "air_c", "largest_air_step_k",
                                 "emitter",   "modbus", "can"};
  add_names(known, "range_sigma", Dimension::kLength);
  add_names(known, "reading_timeout", Dimension::kTime);
  ARMSIG_TRY(map, YamlMap::open(node, "the sensor", known));
  if (auto array = read_array(map, c); !array) return array;
  ARMSIG_TRY(emitter, map.require("emitter"));
  ARMSIG_TRY(p_nT, read_point(*emitter, "the emitter"));
  if (!(p_nT.cwiseAbs().maxCoeff() <= kEmitter.highest)) {
    return problem_at(*emitter, fmt::format("the emitter at {:.6g} m", p_nT.cwiseAbs().maxCoeff()),
                      fmt::format("within {} m: {}", kEmitter.highest, kEmitter.reason));
  }
  c.p_nT = p_nT;
  const YamlNode* serial = map.find("modbus");
  const YamlNode* can = map.find("can");
  if ((serial == nullptr) == (can == nullptr)) {
    return problem_at(can == nullptr ? node : *can,
                      can == nullptr ? "the sensor is on no bus" : "the sensor is on two buses",
                      "modbus or can");
  }
  return serial != nullptr ? read_modbus(*serial, c) : read_can(*can, c);
}

}  // namespace armsig::daemon
