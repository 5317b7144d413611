// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/base/pose.hpp"
#include "firmware/controller/plausibility.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/yaml_map.hpp"
#include "firmware/linux/drive_keys.hpp"
#include "firmware/linux/sections.hpp"
#include "firmware/linux/sensor_parts.hpp"
#include "firmware/linux/settings.hpp"

namespace armsig::daemon {
namespace {

using tool::add_names;
using tool::Dimension;
using tool::problem_at;
using tool::Read;
using tool::YamlMap;
using tool::YamlNode;

constexpr double kKelvin = 1;

Read<void> read_can(const YamlNode& node, DaemonConfiguration& c) {
  std::vector<std::string> known{"node", "path", "interface"};
  for (const char* time : {"reading_period", "silent_after", "stale_after"}) {
    add_names(known, time, Dimension::kTime);
  }
  ARMSIG_TRY(map, YamlMap::open(node, "can", known));
  canopen::RangeNodeConfiguration sensor;
  ARMSIG_TRY(number, map.integer("node", 1, canopen::kLargestNode));
  sensor.node = static_cast<canopen::NodeId>(number);
  ARMSIG_TRY(bus, read_bus(map, c.can_interfaces));
  c.drives.buses.sink = bus;
  sensor.receivers = c.controller.sensor.receivers.p_S.size();
  hal::Duration period = std::chrono::milliseconds(20);
  Settings settings(map);
  settings.time("reading_period", period);
  read_freshness(settings, period, true, sensor.freshness);
  bound_period(settings, "reading_period", period, sensor.freshness);
  if (auto done = settings.done(); !done) return done;
  if (auto path = read_path(map, sensor.echo); !path) return path;
  if (!canopen::check(sensor)) {
    return problem_at(node, fmt::format("{} receivers on CAN", sensor.receivers),
                      fmt::format("at most {}", canopen::kMaxCanReceivers));
  }
  c.drives.others[bus].nodes.push_back(sensor.node);
  for (const canopen::PeriodicFrame& frame : canopen::traffic(sensor, period)) {
    c.drives.others[bus].traffic.push_back(frame);
  }
  c.sensor = sensor;
  return {};
}

// Fewer ranges leave a target on a circle or a sphere, however many poses are measured.
Read<void> check_count(const YamlNode& receivers) {
  constexpr std::size_t kLeast = 3;
  const std::size_t count = receivers.items.size();
  if (receivers.kind != YamlNode::Kind::kSequence || count == 0 || count >= kLeast) return {};
  return problem_at(
      receivers, fmt::format("{} receiver{}", count, count == 1 ? "" : "s"),
      fmt::format("{} at least: the controller locates the target by ranges of one moment, and "
                  "fewer leave it on a circle. Units with one channel each make up the receivers",
                  kLeast));
}

Read<void> read_array(const YamlMap& map, DaemonConfiguration& c) {
  controller::Sensor& sensor = c.controller.sensor;
  ARMSIG_TRY(node, map.require("receivers"));
  if (auto enough = check_count(*node); !enough) return enough;
  ARMSIG_TRY(list, tool::read_list(*node, "receivers", 3, kMaxReceivers));
  for (const YamlNode& item : *list) {
    const std::string name = fmt::format("receiver {}", sensor.receivers.p_S.size() + 1);
    ARMSIG_TRY(map_of_one, YamlMap::open(item, name, point_keys()));
    ARMSIG_TRY(p_S, read_point(map_of_one, controller::plausible::kReceiver));
    sensor.receivers.p_S.push_back(p_S);
  }
  ARMSIG_TRY(sigma, map.require_quantity("range_sigma", Dimension::kLength));
  (void)sigma;
  Settings settings(map);
  settings.quantity("range_sigma", Dimension::kLength, sensor.receivers.range_sigma_m)
      .share("largest_air_step_k", sensor.largest_air_step_kelvin)
      .time("reading_timeout", sensor.reading_timeout);
  if (auto done = settings.done(); !done) return done;
  if (const YamlNode* air = map.find("air_c")) {
    ARMSIG_TRY(bounds, tool::read_numbers(*air, "air_c", 2));
    if (!(bounds[0] + kKelvin <= bounds[1])) {
      return problem_at(*air, fmt::format("air_c: {} to {}", bounds[0], bounds[1]),
                        "the lowest plausible temperature first, then the highest");
    }
    sensor.lowest_air_celsius = bounds[0];
    sensor.highest_air_celsius = bounds[1];
  }
  return finish_array(map, *node, sensor.receivers);
}

}  // namespace

std::vector<std::string> point_keys() {
  std::vector<std::string> known;
  for (const char* axis : {"x", "y", "z"}) add_names(known, axis, Dimension::kLength);
  return known;
}

Read<Vector3> read_point(const YamlMap& map, const controller::Bounds& bounds) {
  Vector3 point;
  Settings settings(map);
  Eigen::Index axis = 0;
  for (const char* name : {"x", "y", "z"}) {
    ARMSIG_TRY(value_m, map.quantity(name, Dimension::kLength));
    point[axis++] = value_m;
    settings.bound(name, Dimension::kLength, value_m, bounds);
  }
  if (auto done = settings.done(); !done) return std::unexpected(std::move(done).error());
  return point;
}

Read<void> finish_array(const YamlMap& map, const YamlNode& node,
                        measurement::ReceiverArray& array) {
  if (const YamlNode* facing = map.find("facing")) {
    ARMSIG_TRY(facing_S, tool::read_vector3(*facing, "facing"));
    array.facing_S = facing_S;
  }
  if (const auto checked = measurement::check(array); !checked) {
    return problem_at(node, std::string(describe(checked.error())),
                      "places, and where they need it `facing`, that tell where a target is");
  }
  return {};
}

Read<Vector3> read_target(const YamlNode& node, const std::string& name) {
  ARMSIG_TRY(map, YamlMap::open(node, name, point_keys()));
  return read_point(map, controller::plausible::kEmitter);
}

Read<void> read_sensor(const YamlNode& node, DaemonConfiguration& c) {
  std::vector<std::string> known{"receivers", "facing", "air_c", "largest_air_step_k",
                                 "emitter",   "modbus", "can"};
  add_names(known, "range_sigma", Dimension::kLength);
  add_names(known, "reading_timeout", Dimension::kTime);
  ARMSIG_TRY(map, YamlMap::open(node, "the sensor", known));
  if (auto array = read_array(map, c); !array) return array;
  ARMSIG_TRY(emitter, map.require("emitter"));
  ARMSIG_TRY(p_nT, read_target(*emitter, "the emitter"));
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
