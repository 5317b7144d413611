// SPDX-License-Identifier: MIT
#include <chrono>
#include <string>
#include <string_view>
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

}  // namespace

Read<void> read_points(const YamlNode& node, DaemonConfiguration& c) {
  std::vector<std::string> known{"target", "port", "address", "client"};
  add_names(known, "sigma", Dimension::kLength);
  for (const char* time : {"age", "reading_timeout", "silent_after", "stale_after"}) {
    add_names(known, time, Dimension::kTime);
  }
  ARMSIG_TRY(map, YamlMap::open(node, "points", known));
  ARMSIG_TRY(target, map.require("target"));
  ARMSIG_TRY(p_nT, read_target(*target, "the target"));
  c.p_nT = p_nT;
  linux_hal::PointServerConfiguration points;
  if (auto read = read_connection(map, points); !read) return read;
  controller::Sensor& sensor = c.controller.sensor;
  sensor.measures = controller::Measures::kPoints;
  ARMSIG_TRY(sigma, map.require_quantity("sigma", Dimension::kLength));
  (void)sigma;
  Settings settings(map);
  settings.quantity("sigma", Dimension::kLength, sensor.point_sigma_m)
      .bound("sigma", Dimension::kLength, sensor.point_sigma_m, kInstrumentSigma)
      .time("age", points.age)
      .bound("age", Dimension::kTime, hal::seconds(points.age), kPointAge)
      .time("reading_timeout", sensor.reading_timeout)
      .time("silent_after", points.freshness.silent_after)
      .time("stale_after", points.freshness.stale_after);
  if (auto done = settings.done(); !done) return done;
  c.sensor = points;
  return {};
}

}  // namespace armsig::daemon
