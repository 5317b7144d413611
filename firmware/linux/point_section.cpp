// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "firmware/controller/plausibility.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/yaml_map.hpp"
#include "firmware/linux/sections.hpp"
#include "firmware/linux/sensor_parts.hpp"
#include "firmware/linux/settings.hpp"

namespace armsig::daemon {
namespace {

namespace plausible = controller::plausible;
using controller::plausible::kInstrumentSigma;
using controller::plausible::kPointAge;
using tool::add_names;
using tool::Dimension;
using tool::problem_at;
using tool::Read;
using tool::YamlMap;
using tool::YamlNode;

// Ports below are of services of the system.
constexpr int kLeastPort = 1024;
constexpr int kLargestPort = 65535;

// An address in numbers: whoever resolves a name asks others who they are.
Read<void> read_address(const YamlMap& map, std::string_view key, std::string& address) {
  const YamlNode* const node = map.find(key);
  if (node == nullptr) return {};
  address = linux_hal::canonical_address(node->text);
  if (!address.empty()) return {};
  return problem_at(*node, fmt::format("{}: {}", key, tool::in_quotes(node->text)),
                    "an IPv4 or IPv6 address in numbers, such as 192.168.5.10");
}

Read<void> read_connection(const YamlMap& map, linux_hal::PointServerConfiguration& points) {
  ARMSIG_TRY(port, map.integer("port", kLeastPort, kLargestPort));
  points.port = static_cast<std::uint16_t>(port);
  if (auto read = read_address(map, "address", points.address); !read) return read;
  return read_address(map, "client", points.client);
}

// The registers of an instrument that is a Modbus TCP server.
Read<void> read_registers(const YamlMap& map, modbus::PointProfile& profile) {
  constexpr int kLargestRegister = 0xFFFF;
  if (auto format = read_format(map, profile.format); !format) return format;
  if (auto words = read_word_order(map, profile.high_word_first); !words) return words;
  for (const auto& [key, number] :
       {std::pair("x", &profile.x), std::pair("y", &profile.y), std::pair("z", &profile.z)}) {
    ARMSIG_TRY(first, map.integer(key, 0, kLargestRegister));
    *number = static_cast<std::uint16_t>(first);
  }
  if (map.find("counter") != nullptr) {
    ARMSIG_TRY(counter, map.integer("counter", 0, kLargestRegister));
    profile.counter = static_cast<std::uint16_t>(counter);
  }
  ARMSIG_TRY(step, map.number("metres_a_step"));
  profile.metres_a_step = step;
  Settings settings(map);
  settings.integer("unit", 1, modbus::kLargestUnit, profile.unit)
      .integer("function", 3, 4, profile.function)
      .share("metres_a_step", profile.metres_a_step)
      .bound("metres_a_step", std::nullopt, profile.metres_a_step, plausible::kPointStep)
      .time("update_period", profile.update_period);
  ARMSIG_TRY(period, map.find_quantity("update_period", Dimension::kTime));
  if (period.has_value() == profile.counter.has_value()) {
    return problem_at(map.node(), "nothing says when a point is new, or two keys do",
                      "counter, or update_period_ms where there is none");
  }
  return settings.done();
}

// How often it is asked, and when it counts as silent. `server`: what `modbus` of `points` has.
Read<void> read_times(const YamlMap& map, const YamlMap& server, const controller::Sensor& sensor,
                      linux_hal::ModbusPointsConfiguration& points) {
  const bool counts = points.profile.counter.has_value();
  if (auto stale = refuse_stale(map, counts); !stale) return stale;
  Settings of_server(server);
  of_server.time("poll_period", points.poll_period)
      .time("answer_timeout", points.answer_timeout)
      .bound("answer_timeout", Dimension::kTime, hal::seconds(points.answer_timeout),
             plausible::kAnswerTimeout);
  const bool by_time = points.profile.update_period > points.poll_period;
  const char* const name = by_time ? "update_period" : "poll_period";
  const hal::Duration longest = std::max(points.poll_period, points.profile.update_period);
  Settings settings(map);
  read_freshness(settings, longest, counts, points.freshness);
  if (auto done = settings.done(); !done) return done;
  of_server.bound(
      name, Dimension::kTime, hal::seconds(longest),
      {plausible::kPollPeriod.lowest,
       std::min(plausible::kPollPeriod.highest, hal::seconds(sensor.reading_timeout) / 2),
       "reading_timeout has to last for two readings"});
  bound_period(of_server, name, longest, points.freshness);
  return of_server.done();
}

// `modbus` of `points`, which has the other keys in `whole`.
Read<void> read_server(const YamlNode& node, const YamlMap& whole, const controller::Sensor& sensor,
                       linux_hal::ModbusPointsConfiguration& points) {
  std::vector<std::string> known{"address", "port", "unit", "function", "format",       "words",
                                 "x",       "y",    "z",    "counter",  "metres_a_step"};
  for (const char* time : {"update_period", "poll_period", "answer_timeout"}) {
    add_names(known, time, Dimension::kTime);
  }
  ARMSIG_TRY(map, YamlMap::open(node, "modbus", known));
  ARMSIG_TRY(address, map.require("address"));
  (void)address;
  if (auto read = read_address(map, "address", points.address); !read) return read;
  if (auto read = read_registers(map, points.profile); !read) return read;
  Settings settings(map);
  settings.integer("port", 1, kLargestPort, points.port);
  if (auto done = settings.done(); !done) return done;
  if (const auto request = modbus::request_of(points.profile); !request) {
    return problem_at(
        map.node(), std::string(describe(request.error())),
        fmt::format("x, y, z and counter in registers of their own, at most {} from the "
                    "first to the last",
                    modbus::kMaxRegisters));
  }
  return read_times(whole, map, sensor, points);
}

// How old a point may be, and when it is missed; of either kind.
Read<void> read_age(const YamlMap& map, controller::Sensor& sensor, hal::Duration& age) {
  Settings settings(map);
  settings.time("age", age)
      .bound("age", Dimension::kTime, hal::seconds(age), kPointAge)
      .time("reading_timeout", sensor.reading_timeout);
  return settings.done();
}

// Of an instrument that armsigd asks, nobody connects.
Read<void> refuse_connection(const YamlMap& map) {
  for (const char* key : {"port", "address", "client"}) {
    const YamlNode* const node = map.find(key);
    if (node == nullptr) continue;
    return problem_at(*node, fmt::format("{} beside modbus", key),
                      "address and port of the server, in modbus");
  }
  return {};
}

}  // namespace

Read<void> read_points(const YamlNode& node, DaemonConfiguration& c) {
  std::vector<std::string> known{"target", "port", "address", "client", "modbus"};
  add_names(known, "sigma", Dimension::kLength);
  for (const char* time : {"age", "reading_timeout", "silent_after", "stale_after"}) {
    add_names(known, time, Dimension::kTime);
  }
  ARMSIG_TRY(map, YamlMap::open(node, "points", known));
  ARMSIG_TRY(target, map.require("target"));
  ARMSIG_TRY(p_nT, read_target(*target, "the target"));
  c.p_nT = p_nT;
  controller::Sensor& sensor = c.controller.sensor;
  sensor.measures = controller::Measures::kPoints;
  ARMSIG_TRY(sigma, map.require_quantity("sigma", Dimension::kLength));
  (void)sigma;
  Settings settings(map);
  settings.quantity("sigma", Dimension::kLength, sensor.point_sigma_m)
      .bound("sigma", Dimension::kLength, sensor.point_sigma_m, kInstrumentSigma);
  if (auto done = settings.done(); !done) return done;
  if (const YamlNode* const server = map.find("modbus")) {
    if (auto alone = refuse_connection(map); !alone) return alone;
    linux_hal::ModbusPointsConfiguration points;
    if (auto read = read_age(map, sensor, points.age); !read) return read;
    if (auto read = read_server(*server, map, sensor, points); !read) return read;
    c.sensor = points;
    return {};
  }
  linux_hal::PointServerConfiguration points;
  if (auto read = read_connection(map, points); !read) return read;
  if (auto read = read_age(map, sensor, points.age); !read) return read;
  settings.time("silent_after", points.freshness.silent_after)
      .time("stale_after", points.freshness.stale_after);
  if (auto done = settings.done(); !done) return done;
  c.sensor = points;
  return {};
}

}  // namespace armsig::daemon
