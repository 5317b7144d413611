// SPDX-License-Identifier: MIT
#include "firmware/linux/refusals.hpp"

#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "firmware/formats/yaml_map.hpp"

namespace armsig::daemon {
namespace {

using tool::Problem;
using tool::YamlNode;

// The value under `name`, or under `name` with a unit; `map` itself where the key is absent and its
// default is to blame.
const YamlNode& value_of(const YamlNode& map, std::string_view name) {
  for (std::size_t i = 0; i < map.keys.size(); ++i) {
    const std::string_view key = map.keys[i].text;
    if (key == name || key.starts_with(std::string(name) + "_")) return map.items[i];
  }
  // NOLINTNEXTLINE(bugprone-return-const-ref-from-parameter): the tree outlives what points into it
  return map;
}

// A setting of one joint, or of all of them.
const YamlNode& joint_value(const YamlNode& root, std::optional<std::size_t> joint,
                            std::string_view name) {
  const YamlNode* list = root.find("joints");
  // NOLINTNEXTLINE(bugprone-return-const-ref-from-parameter): the tree outlives what points into it
  if (list == nullptr) return root;
  if (!joint || *joint >= list->items.size()) return *list;
  return value_of(list->items[*joint], name);
}

// Settings of the controller that the file tells joint by joint.
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kOfJoints{{
    {"arm.joints", "theta"},
    {"arm.limits", "limits"},
    {"limits.speed", "speed"},
    {"limits.acceleration", "acceleration"},
    {"supervision.following_error", "following_error"},
    {"sweeps.configuration", "sweep_at"},
}};

const YamlNode& place_of(const controller::ConfigurationRefusal& refusal, const YamlNode& root) {
  for (const auto& [setting, name] : kOfJoints) {
    if (refusal.setting == setting) return joint_value(root, refusal.joint, name);
  }
  const std::size_t dot = refusal.setting.find('.');
  if (dot == std::string_view::npos) return value_of(root, refusal.setting);
  std::string_view section = refusal.setting.substr(0, dot);
  std::string_view name = refusal.setting.substr(dot + 1);
  if (section == "limits") section = "motion";
  if (section == "sensor" && root.find(section) == nullptr) {
    section = root.find("points") != nullptr ? "points" : "lengths";
  }
  if (name == "taught") name = "corners";
  const YamlNode* found = root.find(section);
  return found == nullptr ? root : value_of(*found, name);
}

const YamlNode& in_can(const YamlNode& root, std::string_view name) {
  const YamlNode* can = root.find("can");
  return can == nullptr ? root : value_of(*can, name);
}

const YamlNode& place_of(const canopen::ConfigurationRefusal& refusal, const YamlNode& root) {
  switch (refusal.error) {
    case Error::kNodeOutOfRange:
    case Error::kNodeTwice: {
      if (refusal.axis) return joint_value(root, refusal.axis, "node");
      const YamlNode* sensor = root.find("sensor");
      const YamlNode* can = sensor == nullptr ? nullptr : sensor->find("can");
      return can == nullptr ? in_can(root, "master_node") : value_of(*can, "node");
    }
    case Error::kScaleInvalid:
    case Error::kResolutionTooCoarse:
      return joint_value(root, refusal.axis, "counts_per_revolution");
    case Error::kBusOverload:
      return value_of(root, "period");
    case Error::kPeriodInvalid:
      return refusal.axis ? joint_value(root, refusal.axis, "speed") : in_can(root, "interface");
    default:
      return joint_value(root, refusal.axis, "limits");
  }
}

// Of two buses the one that is to blame: of the joint, of the sensor, or the one that is
// overloaded.
std::string on_which(const canopen::ConfigurationRefusal& refusal,
                     const canopen::Configuration& drives,
                     std::span<const std::string> interfaces) {
  if (interfaces.size() < 2) return {};
  std::uint8_t bus = refusal.axis ? drives.axes[*refusal.axis].bus : drives.buses.sink;
  if (refusal.error == Error::kBusOverload) {
    bus = canopen::periodic_load(drives, 0) > canopen::kLargestBusLoad ? 0 : 1;
  }
  return " on " + interfaces[bus];
}

std::string joint_words(std::optional<std::size_t> joint) {
  return joint ? fmt::format("joint {}: ", *joint + 1) : std::string();
}

std::string because(std::string_view reason) {
  return reason.empty() ? std::string() : fmt::format(": {}", reason);
}

Problem problem(const YamlNode& place, std::string what, std::string expected) {
  return tool::problem_at(place, std::move(what), std::move(expected)).error();
}

// What comes too near to what: where the arm stands, or on a sweep.
Problem problem_of_place(const controller::ConfigurationRefusal& refusal, const YamlNode& root) {
  const YamlNode* list = root.find("joints");
  const std::size_t joints = list == nullptr ? kMaxJoints : list->items.size();
  const tool::LengthWords words = lengths_of(root);
  const bool sweeps = refusal.found != refusal.room.left_m;
  if (!sweeps) {
    return problem(place_of(refusal, root),
                   fmt::format("in the signature configuration {}",
                               tool::room_in_words(refusal.room, joints, words)),
                   fmt::format("{:g} {} of room: sweep_at elsewhere, a larger box, or where the "
                               "floor is (floor_mm) and how thick the links are (link_radius_mm)",
                               words.per_m * refusal.needed, words.unit));
  }
  return problem(place_of(refusal, root),
                 fmt::format("joint {}: what is around the arm leaves {:.0f} degrees of its sweep",
                             *refusal.joint + 1, degrees(refusal.found)),
                 fmt::format("{:.0f} degrees at least: sweep_at elsewhere, or a larger box",
                             degrees(refusal.needed)));
}

}  // namespace

tool::LengthWords lengths_of(const YamlNode& root) {
  const YamlNode* workspace = root.find("workspace");
  if (workspace == nullptr) return {};
  for (const char* side : {"x_m", "y_m", "z_m"}) {
    if (workspace->find(side) != nullptr) return {.unit = "m", .per_m = 1};
  }
  return {};
}

Problem problem_of(const controller::ConfigurationRefusal& refusal, const YamlNode& root) {
  if (refusal.error == Error::kOutsideWorkspace) return problem_of_place(refusal, root);
  return problem(place_of(refusal, root),
                 fmt::format("{}{}: {}, found {:.6g}", joint_words(refusal.joint), refusal.setting,
                             describe(refusal.error), refusal.found),
                 fmt::format("the bound {:.6g} kept (radians, metres, seconds){}", refusal.needed,
                             because(refusal.reason)));
}

Problem problem_of(const canopen::ConfigurationRefusal& refusal, const YamlNode& root,
                   const canopen::Configuration& drives, std::span<const std::string> interfaces) {
  const YamlNode& place = place_of(refusal, root);
  const std::string on = on_which(refusal, drives, interfaces);
  const std::string what = joint_words(refusal.axis) + std::string(describe(refusal.error));
  switch (refusal.error) {
    case Error::kBusOverload:
      return problem(place, fmt::format("{}{}: {:.1f} %", what, on, 100 * refusal.found),
                     fmt::format("at most {:.0f} %: a longer period, fewer joints or a faster bus",
                                 100 * refusal.needed));
    case Error::kNodeTwice:
      return problem(place, fmt::format("{}: node {:.0f}{}", what, refusal.found, on),
                     "a node number of its own for each drive, the sensor and the master; two "
                     "joints of one drive have two axes of it");
    case Error::kScaleInvalid:
    case Error::kResolutionTooCoarse:
      return problem(
          place,
          fmt::format("{}, found {:.6g} counts a revolution of the output", what, refusal.found),
          "counts of a motor revolution, and motor revolutions of one of the output");
    case Error::kPeriodInvalid:
      return problem(place, fmt::format("{}, found {:.6g}", what, refusal.found),
                     fmt::format("times that the drives can take and that suit each other; the "
                                 "bound here is {:.6g} s{}",
                                 refusal.needed, because(refusal.reason)));
    default:
      return problem(place, fmt::format("{}, found {:.6g}", what, refusal.found),
                     fmt::format("the bound {:.6g} kept (radians, metres, seconds){}",
                                 refusal.needed, because(refusal.reason)));
  }
}

}  // namespace armsig::daemon
