// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/canonical.hpp"
#include "firmware/formats/mounting.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/yaml_map.hpp"
#include "firmware/linux/daemon_configuration.hpp"
#include "firmware/linux/refusals.hpp"
#include "firmware/linux/sections.hpp"
#include "firmware/linux/settings.hpp"

namespace armsig::daemon {
namespace {

using tool::add_names;
using tool::Dimension;
using tool::problem_at;
using tool::Read;
using tool::YamlMap;
using tool::YamlNode;

constexpr int kMost = 1'000;

// Where the section is absent its defaults are good.
template <typename F>
Read<void> in_section(const YamlMap& root, std::string_view name,
                      const std::vector<std::string>& known, const F& read) {
  const YamlNode* node = root.find(name);
  if (node == nullptr) return {};
  ARMSIG_TRY(map, YamlMap::open(*node, std::string(name), known));
  Settings settings(map);
  read(settings);
  return settings.done();
}

// No ramp is known to be steeper than the joint's acceleration: the torque would go in its middle.
double longest_stop_s(const controller::MotionLimits& limits) {
  double longest_s = 0;
  for (std::size_t joint = 0; joint < limits.speed.size(); ++joint) {
    longest_s = std::max(longest_s, limits.speed[joint] / limits.acceleration[joint]);
  }
  return longest_s;
}

Read<YamlMap> open_can(const YamlMap& root) {
  std::vector<std::string> known{"interface",    "second_interface",     "bits_per_second",
                                 "master_node",  "other_nodes",          "second_other_nodes",
                                 "sdo_attempts", "missed_feedback_limit"};
  for (const char* time : {"heartbeat", "heartbeat_timeout", "boot_timeout", "sdo_timeout",
                           "transition_timeout", "stop_timeout", "homing_timeout",
                           "targets_ignored", "limited", "lagging", "warning", "voltage_lost"}) {
    add_names(known, time, Dimension::kTime);
  }
  ARMSIG_TRY(node, root.require("can"));
  return YamlMap::open(*node, "can", known);
}

// Devices of a bus that are started with the drives: grippers, valves, inputs and outputs.
Read<void> read_other_nodes(const YamlMap& can, std::string_view key, std::uint8_t bus,
                            DaemonConfiguration& c) {
  constexpr std::size_t kMostBesideSensor = canopen::kMaxOtherNodes - 1;
  const YamlNode* list = can.find(key);
  if (list == nullptr) return {};
  if (bus >= c.drives.buses.count) {
    return problem_at(*list, fmt::format("{} without second_interface", key),
                      "second_interface too, or other_nodes alone");
  }
  ARMSIG_TRY(items, tool::read_list(*list, key, 1, kMostBesideSensor));
  auto& others = c.drives.others[bus].nodes;
  for (const YamlNode& item : *items) {
    ARMSIG_TRY(number, tool::read_integer(item, key, 1, canopen::kLargestNode));
    const auto node = static_cast<canopen::NodeId>(number);
    const bool is_joints = std::ranges::any_of(
        c.drives.axes, [&](const auto& axis) { return axis.bus == bus && axis.node == node; });
    if (is_joints || node == c.drives.master_node || std::ranges::count(others, node) != 0) {
      return problem_at(item, fmt::format("{}: {}", key, number),
                        "a node that is no joint's, not the master's, and named once");
    }
    others.push_back(node);
  }
  return {};
}

Read<std::string> read_interface(const YamlMap& can, std::string_view key) {
  ARMSIG_TRY(interface, can.text(key));
  constexpr std::size_t kLongestName = 15;
  if (interface.size() <= kLongestName) return interface;
  return problem_at(*can.find(key), fmt::format("{}: {}", key, tool::in_quotes(interface)),
                    "the name of a network interface, at most 15 characters");
}

// Before the joints, which name them.
Read<void> read_interfaces(const YamlMap& root, DaemonConfiguration& c) {
  ARMSIG_TRY(map, open_can(root));
  ARMSIG_TRY(first, read_interface(map, "interface"));
  c.can_interfaces.push_back(first);
  const YamlNode* node = map.find("second_interface");
  if (node == nullptr) return {};
  ARMSIG_TRY(second, read_interface(map, "second_interface"));
  if (second == first) {
    return problem_at(*node, "second_interface: " + tool::in_quotes(second),
                      "another interface than the first, or no such key");
  }
  c.can_interfaces.push_back(second);
  c.drives.buses.count = 2;
  return {};
}

// Of two interfaces both have drives.
Read<void> check_interfaces(const YamlMap& can, const DaemonConfiguration& c) {
  for (std::uint8_t bus = 0; c.drives.buses.count > 1 && bus < c.drives.buses.count; ++bus) {
    if (std::ranges::count(c.drives.axes, bus, &canopen::AxisConfiguration::bus) != 0) continue;
    const std::string_view key = bus == 0 ? "interface" : "second_interface";
    const std::string& name = c.can_interfaces[bus];
    return problem_at(*can.find(key),
                      fmt::format("{}: {} has no drive", key, tool::in_quotes(name)),
                      fmt::format("joints with `interface: {}`, or one interface alone", name));
  }
  return {};
}

Read<void> read_can(const YamlMap& root, DaemonConfiguration& c) {
  ARMSIG_TRY(map, open_can(root));
  Settings settings(map);
  settings.integer("bits_per_second", 125'000, 1'000'000, c.drives.bits_per_second)
      .integer("master_node", 1, canopen::kLargestNode, c.drives.master_node)
      .time("heartbeat", c.drives.heartbeat)
      .time("heartbeat_timeout", c.drives.heartbeat_timeout)
      .time("boot_timeout", c.drives.boot_timeout)
      .time("sdo_timeout", c.drives.sdo_timeout)
      .integer("sdo_attempts", 1, kMost, c.drives.sdo_attempts)
      .time("transition_timeout", c.drives.transition_timeout)
      .time("stop_timeout", c.drives.stop_timeout)
      .time("homing_timeout", c.drives.homing_timeout)
      .time("targets_ignored", c.drives.status_limits.ignores)
      .time("limited", c.drives.status_limits.limits)
      .time("lagging", c.drives.status_limits.lags)
      .time("warning", c.drives.status_limits.warns)
      .time("voltage_lost", c.drives.status_limits.no_voltage)
      .integer("missed_feedback_limit", 1, kMost, c.drives.missed_feedback_limit);
  if (auto done = settings.done(); !done) return done;
  if (auto used = check_interfaces(map, c); !used) return used;
  if (auto read = read_other_nodes(map, "other_nodes", 0, c); !read) return read;
  return read_other_nodes(map, "second_other_nodes", 1, c);
}

// Once speeds and accelerations are known to be plausible.
Read<void> check_stop(const YamlMap& root, const DaemonConfiguration& c) {
  ARMSIG_TRY(map, open_can(root));
  return Settings(map)
      .bound("stop_timeout", Dimension::kTime, hal::seconds(c.drives.stop_timeout),
             {longest_stop_s(c.controller.limits), controller::plausible::kLongestStop_s,
              "a joint stops from its speed at its acceleration, and keeps its torque until then"})
      .done();
}

Read<void> read_motion(const YamlMap& root, DaemonConfiguration& c) {
  controller::MotionLimits& limits = c.controller.limits;
  std::vector<std::string> known{"least_regularity"};
  add_names(known, "tool_speed", Dimension::kSpeed);
  add_names(known, "tool_turn_rate", Dimension::kAngularSpeed);
  return in_section(root, "motion", known, [&](Settings& settings) {
    settings.quantity("tool_speed", Dimension::kSpeed, limits.tool_speed)
        .quantity("tool_turn_rate", Dimension::kAngularSpeed, limits.tool_turn_rate)
        .share("least_regularity", limits.least_regularity);
  });
}

Read<void> read_dwell(const YamlMap& root, DaemonConfiguration& c) {
  controller::Dwell& dwell = c.controller.dwell;
  std::vector<std::string> known{"tolerance_rad_or_m", "pings", "most_pings"};
  add_names(known, "settle", Dimension::kTime);
  add_names(known, "settle_timeout", Dimension::kTime);
  return in_section(root, "dwell", known, [&](Settings& settings) {
    settings.share("tolerance_rad_or_m", dwell.tolerance)
        .time("settle", dwell.settle)
        .time("settle_timeout", dwell.settle_timeout)
        .integer("pings", 1, kMost, dwell.pings)
        .integer("most_pings", 1, kMost, dwell.most_pings);
  });
}

Read<void> read_sweeps(const YamlMap& root, DaemonConfiguration& c) {
  controller::SweepPlan& plan = c.controller.sweeps;
  std::vector<std::string> known{"points", "most_points", "validation_poses", "validation_reach",
                                 "target"};
  add_names(known, "arc", Dimension::kAngle);
  add_names(known, "axis_sigma", Dimension::kAngle);
  add_names(known, "point_sigma", Dimension::kLength);
  auto read = in_section(root, "sweeps", known, [&](Settings& settings) {
    settings.quantity("arc", Dimension::kAngle, plan.arc_rad)
        .integer("points", 1, kMost, plan.points)
        .integer("most_points", 1, kMost, plan.most_points)
        .quantity("axis_sigma", Dimension::kAngle, plan.axis_sigma_rad)
        .quantity("point_sigma", Dimension::kLength, plan.point_sigma_m)
        .integer("validation_poses", 1, kMost, plan.validation_poses)
        .share("validation_reach", plan.validation_reach)
        .integer("target", 1, kMost, plan.target);
  });
  for (double& arc_rad : plan.arcs_rad) arc_rad = arc_rad > 0 ? arc_rad : plan.arc_rad;
  return read;
}

Read<void> read_check(const YamlMap& root, DaemonConfiguration& c) {
  constexpr int kMostHours = 720;
  int every_hours = 0;
  auto read = in_section(root, "check", {"poses", "every_hours"}, [&](Settings& settings) {
    settings.integer("poses", 1, kMost, c.controller.check.poses)
        .integer("every_hours", 0, kMostHours, every_hours);
  });
  c.controller.check.every = std::chrono::hours(every_hours);
  return read;
}

// The box of `workspace`, and what the hand carries.
Read<void> read_workspace(const YamlNode& node, clearance::Surroundings& around) {
  std::vector<std::string> known;
  for (const char* name : {"x", "y", "z", "hand"}) add_names(known, name, Dimension::kLength);
  ARMSIG_TRY(map, YamlMap::open(node, "workspace", known));
  // What the hand carries may be told without a box.
  const bool only_hand = node.keys.size() == 1 && node.keys[0].text.starts_with("hand");
  for (Eigen::Index axis = 0; axis < 3 && !only_hand; ++axis) {
    const std::string_view name = std::string_view("xyz").substr(static_cast<std::size_t>(axis), 1);
    ARMSIG_TRY(side, map.require_quantity(name, Dimension::kLength));
    ARMSIG_TRY(numbers, tool::read_numbers(*side.value, side.key->text, 2));
    around.lower_B[axis] = side.unit.to_si(numbers[0]);
    around.upper_B[axis] = side.unit.to_si(numbers[1]);
  }
  Settings settings(map);
  return settings.quantity("hand", Dimension::kLength, around.hand_m).done();
}

// What the whole arm stays clear of, and what that leaves of the sweeps.
Read<void> read_surroundings(const YamlMap& root, const YamlNode& node, DaemonConfiguration& c) {
  ARMSIG_TRY(mounting, tool::read_mounting(root));
  clearance::Surroundings& around = c.controller.around;
  c.controller.drawing.up_0 = -clearance::gravity_B(c.controller.drawing, mounting);
  around = clearance::surroundings_of(c.controller.drawing, mounting);
  around.hand_m = c.p_nT.norm();
  c.lengths = lengths_of(node);
  if (const YamlNode* workspace = root.find("workspace")) {
    if (auto done = read_workspace(*workspace, around); !done) return done;
  }
  controller::limit_sweeps(c.controller);
  return {};
}

Read<void> read_supervision(const YamlMap& root, DaemonConfiguration& c) {
  std::vector<std::string> known;
  add_names(known, "latest_tick", Dimension::kTime);
  return in_section(root, "supervision", known, [&](Settings& settings) {
    settings.time("latest_tick", c.controller.supervision.latest_tick);
  });
}

Read<void> read_top(const YamlMap& root, DaemonConfiguration& c) {
  ARMSIG_TRY(name, root.text("name"));
  ARMSIG_TRY(console, root.text("console"));
  ARMSIG_TRY(store, root.text("store"));
  c.name = name;
  c.console = console;
  c.store = store;
  Settings settings(root);
  settings.time("period", c.controller.period)
      .integer("priority", 0, 99, c.priority)
      .text("black_box", c.black_box)
      .text("reporting_console", c.reporting_console);
  if (auto done = settings.done(); !done) return done;
  c.drives.period = c.controller.period;
  return {};
}

// Whether a second person may stand in for the measurement of a signature that was sent.
Read<void> read_accept_sent(const YamlMap& root, DaemonConfiguration& c) {
  const YamlNode* const node = root.find("accept_sent");
  if (node == nullptr) return {};
  if (node->text != "measured" && node->text != "confirmed") {
    return problem_at(*node, "accept_sent: " + tool::in_quotes(node->text),
                      "measured or confirmed");
  }
  c.controller.sent_needs = node->text == "measured" ? controller::SentNeeds::kMeasured
                                                     : controller::SentNeeds::kConfirmed;
  return {};
}

// What the drives, now known, tell of the bus and of the readings.
Read<void> take_drives(const YamlNode& node, DaemonConfiguration& c) {
  const auto drives = canopen::check(c.drives);
  if (!drives) return std::unexpected(problem_of(drives.error(), node, c.drives, c.can_interfaces));
  for (std::uint8_t bus = 0; bus < c.drives.buses.count; ++bus) {
    c.bus_loads.push_back(drives->bus_load(bus));
  }
  c.controller.feedback_age = c.drives.missed_feedback_limit * c.controller.period;
  for (std::size_t axis = 0; axis < c.drives.axes.size(); ++axis) {
    c.controller.resolution.push_back(drives->scaling(axis).resolution());
  }
  return {};
}

// A sensor of ranges, an instrument of points or of lengths, or none of them: then signatures come
// from elsewhere.
Read<void> read_instrument(const YamlMap& root, DaemonConfiguration& c) {
  constexpr std::array kOfOne{std::pair("sensor", &read_sensor), std::pair("points", &read_points),
                              std::pair("lengths", &read_lengths)};
  const char* one = nullptr;
  for (const auto& [name, read] : kOfOne) {
    const YamlNode* const node = root.find(name);
    if (node == nullptr) continue;
    if (one != nullptr) {
      return problem_at(*node, fmt::format("{} beside {}", name, one),
                        "one of sensor, points and lengths, or none");
    }
    one = name;
    c.controller.sensor.settings_crc = tool::content_crc32(*node);
    if (auto done = read(*node, c); !done) return done;
  }
  if (one != nullptr) return {};
  c.sensor = std::monostate();
  c.controller.sensor.measures = controller::Measures::kNothing;
  return {};
}

Read<void> read_settings(const YamlMap& root, const YamlNode& node, DaemonConfiguration& c) {
  ARMSIG_TRY(joints, root.require("joints"));
  if (auto ok = read_top(root, c); !ok) return ok;
  if (auto ok = read_accept_sent(root, c); !ok) return ok;
  if (auto ok = read_interfaces(root, c); !ok) return ok;
  if (auto ok = read_joints(*joints, c); !ok) return ok;
  if (const YamlNode* coupling = root.find("coupling")) {
    ARMSIG_TRY(couplings, tool::read_couplings(*coupling, c.controller.drawing.joints));
    c.controller.drawing.couplings = couplings;
  }
  if (auto ok = read_can(root, c); !ok) return ok;
  if (auto ok = read_instrument(root, c); !ok) return ok;
  for (const auto read : {read_motion, read_supervision, read_dwell, read_sweeps, read_check}) {
    if (auto ok = read(root, c); !ok) return ok;
  }
  if (auto ok = read_surroundings(root, node, c); !ok) return ok;
  if (auto ok = take_drives(node, c); !ok) return ok;
  if (const YamlNode* emulated = root.find("virtual")) {
    if (auto ok = read_virtual(*emulated, c); !ok) return ok;
  }
  if (const YamlNode* touches = root.find("touches")) {
    if (auto ok = read_touch_files(*touches, c); !ok) return ok;
  }
  if (const YamlNode* grid = root.find("grid")) {
    if (auto ok = read_grid(*grid, c); !ok) return ok;
  }
  const auto checked = controller::check(c.controller);
  if (!checked) return std::unexpected(problem_of(checked.error(), node));
  return check_stop(root, c);
}

Read<DaemonConfiguration> configuration_from(const YamlNode& node) {
  if (auto tag = tool::check_tag(node, kConfigurationTag); !tag) {
    return std::unexpected(std::move(tag).error());
  }
  std::vector<std::string> known{"armsig",  "accept_sent", "name",      "console",
                                 "store",   "priority",    "black_box", "joints",
                                 "can",     "sensor",      "motion",    "supervision",
                                 "dwell",   "points",      "sweeps",    "check",
                                 "grid",    "coupling",    "workspace", "reporting_console",
                                 "virtual", "lengths",     "touches"};
  add_names(known, "period", Dimension::kTime);
  tool::add_mounting_keys(known);
  ARMSIG_TRY(root, YamlMap::open(node, "the controller", known));
  DaemonConfiguration c;
  if (auto read = read_settings(root, node, c); !read) {
    return std::unexpected(std::move(read).error());
  }
  return c;
}

}  // namespace

Read<DaemonConfiguration> parse_configuration(std::string_view text, std::string_view file) {
  const auto parse = [&]() -> Read<DaemonConfiguration> {
    ARMSIG_TRY(root, tool::parse_yaml(text));
    return configuration_from(root);
  };
  return tool::in_file(file, parse());
}

Read<DaemonConfiguration> read_configuration(const std::string& path) {
  ARMSIG_TRY(text, tool::read_text_file(path));
  return parse_configuration(text, path);
}

}  // namespace armsig::daemon
