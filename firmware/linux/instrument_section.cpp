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

Read<void> read_connection(const YamlMap& map, linux_hal::LineServerConfiguration& points) {
  ARMSIG_TRY(port, map.integer("port", kLeastPort, kLargestPort));
  points.port = static_cast<std::uint16_t>(port);
  if (auto read = read_address(map, "address", points.address); !read) return read;
  return read_address(map, "client", points.client);
}

// `registers`: one for each of `anchors` lengths.
Read<void> read_length_registers(const YamlMap& map, std::size_t anchors,
                                 modbus::NumberProfile& profile) {
  ARMSIG_TRY(node, map.require("registers"));
  ARMSIG_TRY(list, tool::read_list(*node, "registers", anchors, anchors));
  for (const YamlNode& item : *list) {
    ARMSIG_TRY(first, tool::read_integer(item, "registers", 0, kLargestRegister));
    profile.registers.push_back(static_cast<std::uint16_t>(first));
  }
  return {};
}

// The registers of an instrument that is a Modbus TCP server: of x, y and z, or of the lengths from
// so many anchors.
Read<void> read_registers(const YamlMap& map, std::size_t anchors, modbus::NumberProfile& profile) {
  if (auto format = read_format(map, profile.format); !format) return format;
  if (auto words = read_word_order(map, profile.high_word_first); !words) return words;
  if (anchors > 0) {
    if (auto read = read_length_registers(map, anchors, profile); !read) return read;
  } else {
    for (const char* key : {"x", "y", "z"}) {
      ARMSIG_TRY(first, map.integer(key, 0, kLargestRegister));
      profile.registers.push_back(static_cast<std::uint16_t>(first));
    }
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

// How often it is asked, and when it counts as silent. `server`: what `modbus` has.
Read<void> read_times(const YamlMap& map, const YamlMap& server, const controller::Sensor& sensor,
                      linux_hal::RegisterClientConfiguration& points) {
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

// `modbus` of an instrument, which has the other keys in `whole`.
Read<void> read_server(const YamlNode& node, const YamlMap& whole, const controller::Sensor& sensor,
                       linux_hal::RegisterClientConfiguration& points) {
  const std::size_t anchors = sensor.receivers.p_S.size();
  std::vector<std::string> known{"address", "port",  "unit",    "function",
                                 "format",  "words", "counter", "metres_a_step"};
  if (anchors > 0) {
    known.emplace_back("registers");
  } else {
    known.insert(known.end(), {"x", "y", "z"});
  }
  for (const char* time : {"update_period", "poll_period", "answer_timeout"}) {
    add_names(known, time, Dimension::kTime);
  }
  ARMSIG_TRY(map, YamlMap::open(node, "modbus", known));
  ARMSIG_TRY(address, map.require("address"));
  (void)address;
  if (auto read = read_address(map, "address", points.address); !read) return read;
  if (auto read = read_registers(map, anchors, points.profile); !read) return read;
  Settings settings(map);
  settings.integer("port", 1, kLargestPort, points.port);
  if (auto done = settings.done(); !done) return done;
  if (const auto request = modbus::request_of(points.profile); !request) {
    return problem_at(
        map.node(), std::string(describe(request.error())),
        fmt::format("{} and counter in registers of their own, at most {} from the first to the "
                    "last",
                    anchors > 0 ? "lengths" : "x, y, z", modbus::kMaxRegisters));
  }
  return read_times(whole, map, sensor, points);
}

// How old a reading may be, and when it is missed; of either kind.
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

// Where a length is measured from, and what is added to it.
Read<void> read_anchor(const YamlNode& item, DaemonConfiguration& c) {
  auto& anchors = c.controller.sensor.receivers.p_S;
  const std::string name = fmt::format("anchor {}", anchors.size() + 1);
  std::vector<std::string> known = point_keys();
  add_names(known, "offset", Dimension::kLength);
  ARMSIG_TRY(map, YamlMap::open(item, name, known));
  ARMSIG_TRY(p_S, read_point(map, plausible::kAnchor));
  double offset_m = 0;
  Settings settings(map);
  settings.quantity("offset", Dimension::kLength, offset_m, false)
      .bound("offset", Dimension::kLength, offset_m, plausible::kAnchor);
  if (auto done = settings.done(); !done) return done;
  anchors.push_back(p_S);
  c.length_offsets_m.push_back(offset_m);
  return {};
}

Read<void> read_anchors(const YamlMap& map, DaemonConfiguration& c) {
  ARMSIG_TRY(node, map.require("anchors"));
  ARMSIG_TRY(list, tool::read_list(*node, "anchors", 3, hal::kMaxLengths));
  for (const YamlNode& item : *list) {
    if (auto read = read_anchor(item, c); !read) return read;
  }
  controller::Sensor& sensor = c.controller.sensor;
  sensor.receivers.range_sigma_m = sensor.point_sigma_m;
  return finish_array(map, *node, sensor.receivers);
}

// Whether armsigd asks the instrument, or is connected to.
Read<void> read_link(const YamlMap& map, DaemonConfiguration& c) {
  controller::Sensor& sensor = c.controller.sensor;
  if (const YamlNode* const server = map.find("modbus")) {
    if (auto alone = refuse_connection(map); !alone) return alone;
    linux_hal::RegisterClientConfiguration asked;
    if (auto read = read_age(map, sensor, asked.age); !read) return read;
    if (auto read = read_server(*server, map, sensor, asked); !read) return read;
    c.sensor = asked;
    return {};
  }
  linux_hal::LineServerConfiguration told;
  if (auto read = read_connection(map, told); !read) return read;
  if (auto read = read_age(map, sensor, told.age); !read) return read;
  Settings settings(map);
  settings.time("silent_after", told.freshness.silent_after)
      .time("stale_after", told.freshness.stale_after);
  if (auto done = settings.done(); !done) return done;
  c.sensor = told;
  return {};
}

Read<YamlMap> open_instrument(const YamlNode& node, const char* name,
                              std::vector<std::string> known) {
  for (const char* key : {"target", "port", "address", "client", "modbus"}) {
    known.emplace_back(key);
  }
  add_names(known, "sigma", Dimension::kLength);
  for (const char* time : {"age", "reading_timeout", "silent_after", "stale_after"}) {
    add_names(known, time, Dimension::kTime);
  }
  return YamlMap::open(node, name, known);
}

// What is measured, and how well.
Read<void> read_target_and_sigma(const YamlMap& map, DaemonConfiguration& c) {
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
  return settings.done();
}

}  // namespace

Read<void> read_points(const YamlNode& node, DaemonConfiguration& c) {
  ARMSIG_TRY(map, open_instrument(node, "points", {}));
  if (auto read = read_target_and_sigma(map, c); !read) return read;
  return read_link(map, c);
}

Read<void> read_lengths(const YamlNode& node, DaemonConfiguration& c) {
  ARMSIG_TRY(map, open_instrument(node, "lengths", {"anchors", "facing"}));
  if (auto read = read_target_and_sigma(map, c); !read) return read;
  if (auto read = read_anchors(map, c); !read) return read;
  return read_link(map, c);
}

}  // namespace armsig::daemon
