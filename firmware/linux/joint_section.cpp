// SPDX-License-Identifier: MIT
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/yaml_map.hpp"
#include "firmware/linux/drive_keys.hpp"
#include "firmware/linux/sections.hpp"
#include "firmware/linux/settings.hpp"

namespace armsig::daemon {
namespace {

using controller::plausible::kMotorSpeed;
using tool::add_names;
using tool::Dimension;
using tool::Read;
using tool::YamlMap;
using tool::YamlNode;

// Keys with the units of both types: a unit of the other type is told apart from an unknown key.
std::vector<std::string> known_keys() {
  std::vector<std::string> known{"type",
                                 "node",
                                 "counts_per_revolution",
                                 "gear_ratio",
                                 "reversed",
                                 "zero_counts",
                                 "unsupervised",
                                 "warning",
                                 "reference",
                                 "homing_method",
                                 "limits",
                                 "mode",
                                 "writes",
                                 "axis",
                                 "interface",
                                 "sequence_torque_percent"};
  for (const char* angle : {"theta", "alpha", "sweep_arc"}) {
    add_names(known, angle, Dimension::kAngle);
  }
  for (const char* length : {"d", "a", "lead"}) add_names(known, length, Dimension::kLength);
  for (const JointType type : {JointType::kRevolute, JointType::kPrismatic}) {
    for (const char* reading : {"limits", "following_error", "following_window", "sweep_at"}) {
      add_names(known, reading, tool::dimension_of(type));
    }
    for (const char* speed : {"speed", "motor_speed"}) add_names(known, speed, speed_of(type));
    for (const char* acceleration : {"acceleration", "stop_deceleration"}) {
      add_names(known, acceleration, acceleration_of(type));
    }
  }
  return known;
}

// A key in a unit of the other type of joint.
Read<void> refuse_other_units(const YamlMap& map, JointType type) {
  const bool turns = type == JointType::kRevolute;
  const JointType other = turns ? JointType::kPrismatic : JointType::kRevolute;
  const auto refuse = [&](std::string_view name, Dimension wrong, Dimension right) -> Read<void> {
    ARMSIG_TRY(found, map.find_quantity(name, wrong));
    if (!found) return {};
    return tool::problem_at(
        *found->key,
        fmt::format("{} on {}, which is {}", found->key->text, map.name(), tool::word_of(type)),
        tool::any_of(tool::names_of(name, right)));
  };
  for (const char* reading : {"following_error", "following_window", "sweep_at"}) {
    if (auto ok = refuse(reading, tool::dimension_of(other), tool::dimension_of(type)); !ok) {
      return ok;
    }
  }
  for (const char* speed : {"speed", "motor_speed"}) {
    if (auto ok = refuse(speed, speed_of(other), speed_of(type)); !ok) return ok;
  }
  for (const char* acceleration : {"acceleration", "stop_deceleration"}) {
    if (auto ok = refuse(acceleration, acceleration_of(other), acceleration_of(type)); !ok) {
      return ok;
    }
  }
  return {};
}

// What its encoder knows at power-up.
Read<controller::Reference> read_reference(const YamlMap& map) {
  const YamlNode* node = map.find("reference");
  if (node == nullptr || node->text == "absolute") return controller::Reference::kAbsolute;
  if (node->text == "none") return controller::Reference::kNone;
  if (node->text == "homed") return controller::Reference::kHomed;
  return tool::problem_at(*node, "reference: " + tool::in_quotes(node->text),
                          "absolute, homed or none");
}

// How its drive homes, as object 6098h has it.
Read<std::optional<std::int8_t>> read_homing_method(const YamlMap& map,
                                                    controller::Reference reference) {
  const YamlNode* node = map.find("homing_method");
  if (node == nullptr) return std::nullopt;
  if (reference != controller::Reference::kHomed) {
    return tool::problem_at(*node, "homing_method of a joint that is not homed",
                            "reference: homed, or no such key");
  }
  ARMSIG_TRY(method, map.integer("homing_method", -128, 127));
  return static_cast<std::int8_t>(method);
}

// As a share of the rated torque; empty: not watched, nor told by the drive.
Read<std::optional<double>> read_sequence_torque(const YamlMap& map) {
  constexpr int kMostPercent = 300;
  if (map.find("sequence_torque_percent") == nullptr) return std::nullopt;
  ARMSIG_TRY(percent, map.integer("sequence_torque_percent", 1, kMostPercent));
  return percent / 100.0;
}

// How far a revolute joint is swept; 0: as the section `sweeps` says for all.
Read<double> read_arc(const YamlMap& map, JointType type) {
  double arc_rad = 0;
  Settings settings(map);
  settings.quantity("sweep_arc", Dimension::kAngle, arc_rad);
  if (auto done = settings.done(); !done) return std::unexpected(std::move(done).error());
  if (arc_rad > 0 && type == JointType::kPrismatic) {
    return tool::problem_at((*map.find_quantity("sweep_arc", Dimension::kAngle))->key[0],
                            "sweep_arc on " + map.name() + ", which is prismatic",
                            "no arc: a slide is swept over its stroke");
  }
  return arc_rad;
}

// The fastest that the motor can turn the joint: of no use to plans, but positions that change far
// faster are disbelieved.
Read<double> read_motor_speed(const YamlMap& map, JointType type, double speed) {
  double motor_speed = speed;
  Settings settings(map);
  settings.quantity("motor_speed", speed_of(type), motor_speed)
      .bound("motor_speed", speed_of(type), motor_speed, kMotorSpeed.of(type));
  if (auto done = settings.done(); !done) return std::unexpected(std::move(done).error());
  if (motor_speed < speed) {
    const auto told = *map.require_quantity("motor_speed", speed_of(type));
    return tool::problem_at(*told.value,
                            fmt::format("{}: {} is below the speed of {}", told.key->text,
                                        told.value->text, map.name()),
                            "at least that speed");
  }
  return motor_speed;
}

// A drive moves as far as it is told: no limits by default here.
Read<JointLimits> read_stated_limits(const YamlMap& map, JointType type) {
  if (const YamlNode* none = map.find("limits")) {
    return tool::problem_at(
        *none, fmt::format("limits of {} are none, or have no unit", map.name()),
        tool::any_of(tool::names_of("limits", tool::dimension_of(type))) +
            ": a drive counts the turns of a joint without end up to limits, which may be many");
  }
  ARMSIG_TRY(limits, tool::read_limits(map, type));
  ARMSIG_TRY(stated, map.require_quantity("limits", tool::dimension_of(type)));
  (void)stated;
  return limits;
}

Read<void> read_joint(const YamlNode& node, DaemonConfiguration& c) {
  Arm& arm = c.controller.drawing;
  ARMSIG_TRY(map,
             YamlMap::open(node, fmt::format("joint {}", arm.joints.size() + 1), known_keys()));
  ARMSIG_TRY(type, tool::read_joint_type(map));
  if (auto ok = refuse_other_units(map, type); !ok) return ok;
  ARMSIG_TRY(theta_rad, map.quantity("theta", Dimension::kAngle));
  ARMSIG_TRY(d_m, map.quantity("d", Dimension::kLength));
  ARMSIG_TRY(a_m, map.quantity("a", Dimension::kLength));
  ARMSIG_TRY(alpha_rad, map.quantity("alpha", Dimension::kAngle));
  ARMSIG_TRY(limits, read_stated_limits(map, type));
  ARMSIG_TRY(axis, read_drive(map, type));
  ARMSIG_TRY(bus, read_bus(map, c.can_interfaces));
  ARMSIG_TRY(speed, positive(map, "speed", speed_of(type)));
  ARMSIG_TRY(acceleration, positive(map, "acceleration", acceleration_of(type)));
  ARMSIG_TRY(following_error, positive(map, "following_error", tool::dimension_of(type)));
  ARMSIG_TRY(sweep_at, map.quantity("sweep_at", tool::dimension_of(type)));
  ARMSIG_TRY(arc_rad, read_arc(map, type));
  ARMSIG_TRY(reference, read_reference(map));
  ARMSIG_TRY(homing_method, read_homing_method(map, reference));
  ARMSIG_TRY(torque, read_sequence_torque(map));
  axis.torque_told = torque.has_value();
  axis.bus = bus;
  axis.limits = limits;
  axis.homing_method = homing_method;
  ARMSIG_TRY(motor_speed, read_motor_speed(map, type, speed));
  axis.largest_speed = motor_speed;
  arm.joints.push_back({type, theta_rad, d_m, a_m, alpha_rad});
  arm.limits.push_back(limits);
  c.drives.axes.push_back(axis);
  c.controller.references.push_back(reference);
  c.controller.limits.speed.push_back(speed);
  c.controller.limits.acceleration.push_back(acceleration);
  c.controller.supervision.following_error.push_back(following_error);
  c.controller.supervision.sequence_torque.push_back(torque);
  c.controller.sweeps.configuration.push_back(sweep_at);
  c.controller.sweeps.arcs_rad.push_back(arc_rad);
  return {};
}

}  // namespace

Read<void> read_joints(const YamlNode& list, DaemonConfiguration& c) {
  ARMSIG_TRY(joints, tool::read_list(list, "joints", 1, kMaxJoints));
  for (const YamlNode& node : *joints) {
    if (auto read = read_joint(node, c); !read) return read;
  }
  return {};
}

}  // namespace armsig::daemon
