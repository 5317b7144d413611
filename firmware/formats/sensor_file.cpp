// SPDX-License-Identifier: MIT
#include "firmware/formats/sensor_file.hpp"

#include <algorithm>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/measurements.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/yaml_map.hpp"

namespace armsig::tool {
namespace {

// How far the receivers reach from the line through the first and the one farthest from it, as a
// part of the length of that line.
double breadth(const std::vector<Vector3>& receivers_S) {
  Vector3 longest = Vector3::Zero();
  for (const Vector3& p_S : receivers_S) {
    const Vector3 along = p_S - receivers_S.front();
    if (along.norm() > longest.norm()) longest = along;
  }
  const double length = longest.norm();
  if (!(length > 0)) return 0;
  double widest = 0;
  for (const Vector3& p_S : receivers_S) {
    const Vector3 across = (p_S - receivers_S.front()).cross(longest / length);
    widest = std::max(widest, across.norm());
  }
  return widest / length;
}

Read<std::vector<Vector3>> read_receivers(const YamlNode& node) {
  std::vector<std::string> known;
  for (const char* axis : {"x", "y", "z"}) add_names(known, axis, Dimension::kLength);
  ARMSIG_TRY(list, read_list(node, "receivers", 3, kMaxRangeColumns));
  std::vector<Vector3> receivers_S;
  for (const YamlNode& item : *list) {
    ARMSIG_TRY(map, YamlMap::open(item, fmt::format("receiver {}", receivers_S.size() + 1), known));
    ARMSIG_TRY(x_m, map.quantity("x", Dimension::kLength));
    ARMSIG_TRY(y_m, map.quantity("y", Dimension::kLength));
    ARMSIG_TRY(z_m, map.quantity("z", Dimension::kLength));
    receivers_S.emplace_back(x_m, y_m, z_m);
  }
  // Below this no range tells on which side of the line the target is.
  constexpr double kCollinear = 1e-6;
  if (!(breadth(receivers_S) > kCollinear)) {
    return problem_at(node, "the receivers stand on one line", "at least three that span a plane");
  }
  return receivers_S;
}

Read<bool> read_path(const YamlMap& map) {
  ARMSIG_TRY(path, map.text("path"));
  if (path == "one-way") return false;
  if (path == "echo") return true;
  return problem_at(*map.find("path"), "path: " + in_quotes(path), "one-way or echo");
}

Read<SensorDescription> sensor_from(const YamlNode& root) {
  if (auto tag = check_tag(root, kSensorTag); !tag) return std::unexpected(std::move(tag).error());
  std::vector<std::string> known{"armsig", "name",   "receivers",
                                 "path",   "facing", "calibrated_at_c"};
  add_names(known, "range_sigma", Dimension::kLength);
  ARMSIG_TRY(map, YamlMap::open(root, "the sensor", known));
  SensorDescription sensor;
  ARMSIG_TRY(name, map.name_under("name"));
  ARMSIG_TRY(receivers, map.require("receivers"));
  ARMSIG_TRY(receivers_S, read_receivers(*receivers));
  ARMSIG_TRY(sigma_m, map.quantity("range_sigma", Dimension::kLength));
  if (!(sigma_m > 0)) {
    ARMSIG_TRY(sigma, map.require_quantity("range_sigma", Dimension::kLength));
    return problem_at(*sigma.value,
                      fmt::format("{}: {} is not positive", sigma.key->text, sigma.value->text),
                      "a standard deviation above 0");
  }
  ARMSIG_TRY(echo, read_path(map));
  sensor.name = name;
  sensor.receivers_S = receivers_S;
  sensor.range_sigma_m = sigma_m;
  sensor.echo = echo;
  if (const YamlNode* node = map.find("facing")) {
    ARMSIG_TRY(facing_S, read_vector3(*node, "facing"));
    sensor.facing_S = direction_of(facing_S);
    if (sensor.facing_S->isZero(0)) {
      return problem_at(*node, "facing: a vector of no length", "a direction");
    }
  }
  if (const YamlNode* node = map.find("calibrated_at_c")) {
    constexpr double kAbsoluteZero = -273.15;
    ARMSIG_TRY(calibrated_at_c, read_number(*node, "calibrated_at_c"));
    if (!(calibrated_at_c > kAbsoluteZero)) {
      return problem_at(*node, fmt::format("calibrated_at_c: {}", node->text),
                        "a temperature above absolute zero");
    }
    sensor.calibrated_at_c = calibrated_at_c;
  }
  return sensor;
}

}  // namespace

Read<SensorDescription> parse_sensor(std::string_view text, std::string_view file) {
  const auto parse = [&]() -> Read<SensorDescription> {
    ARMSIG_TRY(root, parse_yaml(text));
    return sensor_from(root);
  };
  return in_file(file, parse());
}

Read<SensorDescription> read_sensor_file(const std::string& path) {
  ARMSIG_TRY(text, read_text_file(path));
  return parse_sensor(text, path);
}

std::string sensor_text(const SensorDescription& sensor) {
  std::string text =
      fmt::format("armsig: {}\nname: {}\nreceivers:\n", kSensorTag, yaml_quoted(sensor.name));
  for (const Vector3& p_S : sensor.receivers_S) {
    text += fmt::format("  - {{x_m: {}, y_m: {}, z_m: {}}}\n", number_text(p_S.x()),
                        number_text(p_S.y()), number_text(p_S.z()));
  }
  text += fmt::format("range_sigma_m: {}\npath: {}\n", number_text(sensor.range_sigma_m),
                      sensor.echo ? "echo" : "one-way");
  if (sensor.facing_S) {
    text += fmt::format("facing: [{}, {}, {}]\n", number_text(sensor.facing_S->x()),
                        number_text(sensor.facing_S->y()), number_text(sensor.facing_S->z()));
  }
  if (sensor.calibrated_at_c) {
    text += fmt::format("calibrated_at_c: {}\n", number_text(*sensor.calibrated_at_c));
  }
  return text;
}

Read<void> write_sensor_file(const std::string& path, const SensorDescription& sensor) {
  const std::string text = sensor_text(sensor);
  if (auto check = parse_sensor(text, path); !check) {
    return std::unexpected(std::move(check).error());
  }
  return write_text_file(path, text);
}

}  // namespace armsig::tool
