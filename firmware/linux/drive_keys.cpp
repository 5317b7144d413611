// SPDX-License-Identifier: MIT
#include "firmware/linux/drive_keys.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/linux/settings.hpp"
#include "hal/cia402/setup.hpp"

namespace armsig::daemon {
namespace {

using controller::plausible::kFollowingError;
using tool::Dimension;
using tool::Read;
using tool::YamlMap;
using tool::YamlNode;

constexpr int kLargestNode = canopen::kLargestNode;

// Something about its drive that is known, and seen to otherwise: that it keeps its torque when
// this process is gone, or that it warns.
Read<bool> read_known(const YamlMap& map, const char* key) {
  const YamlNode* node = map.find(key);
  if (node == nullptr) return false;
  if (node->text != "known") {
    return tool::problem_at(*node, fmt::format("{}: {}", key, tool::in_quotes(node->text)),
                            "known, or no such key");
  }
  return true;
}

// How it is given its targets.
Read<cia402::PositionMode> read_mode(const YamlMap& map) {
  const YamlNode* node = map.find("mode");
  if (node == nullptr || node->text == "cyclic") return cia402::PositionMode::kCyclic;
  if (node->text == "interpolated") return cia402::PositionMode::kInterpolated;
  if (node->text == "profile") return cia402::PositionMode::kProfile;
  return tool::problem_at(*node, "mode: " + tool::in_quotes(node->text),
                          "cyclic, interpolated or profile");
}

// "6081h:0": index in hexadecimal, sub-index in decimal.
Read<cia402::ObjectRequest> read_object(const YamlMap& map) {
  ARMSIG_TRY(node, map.require("object"));
  const std::string& text = node->text;
  constexpr std::size_t kIndexDigits = 4;
  const auto refuse = [&] {
    return tool::problem_at(*node, "object: " + tool::in_quotes(text),
                            "index and sub-index, such as 6081h:0");
  };
  const bool marked = text.size() > kIndexDigits + 2 && text[kIndexDigits] == 'h' &&
                      text[kIndexDigits + 1] == ':' && text.size() <= kIndexDigits + 5;
  if (!marked) return refuse();
  cia402::ObjectRequest request;
  const char* begin = text.data();
  const char* end = begin + text.size();
  const auto index = std::from_chars(begin, begin + kIndexDigits, request.index, 16);
  const auto subindex = std::from_chars(begin + kIndexDigits + 2, end, request.subindex, 10);
  if (index.ec != std::errc{} || index.ptr != begin + kIndexDigits) return refuse();
  if (subindex.ec != std::errc{} || subindex.ptr != end) return refuse();
  if (!cia402::may_be_written(request.index)) {
    return tool::problem_at(*node, "object: " + text + " is not free to be written",
                            "an object of the maker (2000h to 5FFFh), or one of CiA 402 that "
                            "armsigd does not set or judge");
  }
  return request;
}

// A number of `bytes`, signed or not.
Read<std::uint32_t> read_value(const YamlMap& map, int bytes) {
  ARMSIG_TRY(node, map.require("value"));
  ARMSIG_TRY(number, tool::read_number(*node, "value"));
  const double range = std::ldexp(1.0, 8 * bytes);
  if (number != std::floor(number) || number < -range / 2 || number > range - 1) {
    return tool::problem_at(*node, "value: " + node->text,
                            fmt::format("a whole number from {:.0f} to {:.0f}, for {} bytes",
                                        -range / 2, range - 1, bytes));
  }
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(number)) &
         static_cast<std::uint32_t>(static_cast<std::int64_t>(range) - 1);
}

Read<void> read_writes(const YamlMap& joint, canopen::AxisConfiguration& axis) {
  const YamlNode* list = joint.find("writes");
  if (list == nullptr) return {};
  ARMSIG_TRY(items, tool::read_list(*list, "writes", 1, cia402::kMaxFurtherWrites));
  for (const YamlNode& item : *items) {
    ARMSIG_TRY(map, YamlMap::open(item, "a write", {"object", "bytes", "value"}));
    ARMSIG_TRY(request, read_object(map));
    ARMSIG_TRY(bytes, map.integer("bytes", 1, 4));
    if (bytes == 3) return tool::problem_at(*map.find("bytes"), "bytes: 3", "1, 2 or 4");
    ARMSIG_TRY(value, read_value(map, bytes));
    request.bytes = static_cast<std::uint8_t>(bytes);
    request.value = value;
    axis.writes.push_back(request);
  }
  return {};
}

// Counts of a revolution of the motor, its gear, and the lead of a slide.
Read<void> read_ratio(const YamlMap& map, JointType type, cia402::ScalingConfiguration& scaling) {
  scaling.type = type;
  ARMSIG_TRY(counts, map.number("counts_per_revolution"));
  ARMSIG_TRY(ratio, map.number("gear_ratio"));
  scaling.counts_per_revolution = counts;
  scaling.gear_ratio = ratio;
  if (type == JointType::kPrismatic) {
    ARMSIG_TRY(lead_m, positive(map, "lead", Dimension::kLength));
    scaling.lead_m = lead_m;
  } else {
    ARMSIG_TRY(lead, map.find_quantity("lead", Dimension::kLength));
    if (lead) {
      return tool::problem_at(
          *lead->key, fmt::format("{} on {}, which is revolute", lead->key->text, map.name()),
          "no lead");
    }
  }
  return {};
}

}  // namespace

Read<double> positive(const YamlMap& map, std::string_view name, Dimension dimension) {
  ARMSIG_TRY(told, map.require_quantity(name, dimension));
  ARMSIG_TRY(number, tool::read_number(*told.value, told.key->text));
  if (!(number > 0)) {
    return tool::problem_at(*told.value, fmt::format("{}: {}", told.key->text, number),
                            "a number above 0");
  }
  return told.unit.to_si(number);
}

Read<std::uint8_t> read_bus(const YamlMap& map, const std::vector<std::string>& interfaces) {
  const YamlNode* node = map.find("interface");
  if (node == nullptr) return std::uint8_t{0};
  const auto found = std::ranges::find(interfaces, node->text);
  if (found != interfaces.end()) return static_cast<std::uint8_t>(found - interfaces.begin());
  const std::string known =
      interfaces.size() == 1 ? interfaces[0] + ", or another as second_interface of the section can"
                             : tool::any_of(interfaces) + ", the interfaces of the section can";
  return tool::problem_at(*node, "interface: " + tool::in_quotes(node->text), known);
}

Read<canopen::AxisConfiguration> read_drive(const YamlMap& map, JointType type) {
  canopen::AxisConfiguration axis;
  cia402::ScalingConfiguration& scaling = axis.scaling;
  ARMSIG_TRY(node, map.integer("node", 1, kLargestNode));
  axis.node = static_cast<canopen::NodeId>(node);
  if (auto read = read_ratio(map, type, scaling); !read) {
    return std::unexpected(std::move(read).error());
  }
  Settings settings(map);
  settings.integer("axis", 1, cia402::kMostAxes, axis.axis)
      .flag("reversed", scaling.reversed)
      .integer("zero_counts", std::numeric_limits<std::int32_t>::min() + 1,
               std::numeric_limits<std::int32_t>::max(), scaling.zero_counts)
      .quantity("following_window", tool::dimension_of(type), axis.following_window)
      .bound("following_window", tool::dimension_of(type), axis.following_window,
             {0, kFollowingError.of(type).highest, kFollowingError.of(type).reason})
      .quantity("stop_deceleration", acceleration_of(type), axis.stop_deceleration);
  if (auto done = settings.done(); !done) return std::unexpected(done.error());
  ARMSIG_TRY(unsupervised, read_known(map, "unsupervised"));
  ARMSIG_TRY(warning, read_known(map, "warning"));
  ARMSIG_TRY(mode, read_mode(map));
  axis.unsupervised_known = unsupervised;
  axis.warning_known = warning;
  axis.mode = mode;
  if (auto read = read_writes(map, axis); !read) return std::unexpected(std::move(read).error());
  return axis;
}

}  // namespace armsig::daemon
