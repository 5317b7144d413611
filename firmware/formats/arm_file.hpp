// SPDX-License-Identifier: MIT
// Arm description, arm/1: what the drawing of an arm says (docs/formats.md).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/arm.hpp"
#include "core/clearance/surroundings.hpp"
#include "firmware/formats/arm_limits.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/yaml_tree.hpp"

namespace armsig::tool {

inline constexpr std::string_view kArmTag = "arm/1";

struct ArmDescription {
  std::string name;
  Arm arm;
  // The key `deviations`, or the defaults. (Without {}, g++ calls it missing where it is left out.)
  ArmLimits limits = {};  // NOLINT(readability-redundant-member-init)
  // What other software calls the joints (the key `name`): one each, no two alike, or none.
  std::vector<std::string> joint_names = {};  // NOLINT(readability-redundant-member-init)
  // The keys `mounted`, `floor` and `link_radius`, or the defaults.
  clearance::Mounting mounting = {};  // NOLINT(readability-redundant-member-init)
  // The key `sweep_at`: the signature configuration, a reading a joint; or none.
  JointVector sweep_at = {};  // NOLINT(readability-redundant-member-init)
};

// A revolute joint without limits gets -180 to 180 degrees; a prismatic one must state them.
[[nodiscard]] Read<ArmDescription> read_arm_file(const std::string& path);

// The same from memory; `file` names the text in problems.
[[nodiscard]] Read<ArmDescription> parse_arm(std::string_view text, std::string_view file);

// The description as text, in radians and metres with 17 digits: reading it gives the same bits.
[[nodiscard]] std::string arm_text(const ArmDescription& description);

// Writes atomically; refuses what could not be read back (a number that is not finite, no name).
[[nodiscard]] Read<void> write_arm_file(const std::string& path, const ArmDescription& description);

// What a YAML file of ours says it is: "arm/1", "signature/1", ...
[[nodiscard]] Read<std::string> read_tag(const std::string& path);

class YamlMap;

// The `coupling` list, shared with the signature file.
[[nodiscard]] Read<JointCouplings> read_couplings(const YamlNode& list, const DhRows& joints);
[[nodiscard]] std::string couplings_text(const JointCouplings& couplings);

// Two readings, the lower first, in the unit of the joint (limits_deg, limits_mm, ...); `limits:
// none` of a joint that turns without end; without them +-180 degrees for a revolute joint. `map`
// must know all keys of add_limit_names().
[[nodiscard]] Read<JointLimits> read_limits(const YamlMap& map, JointType type);
void add_limit_names(std::vector<std::string>& known);
// The key and its value as read_limits() takes them, in SI.
[[nodiscard]] std::string limits_text(JointType type, const JointLimits& limits);

// The key `name` of one more joint, added to `names`; one that it already holds is refused.
[[nodiscard]] Read<void> read_joint_name(const YamlMap& map, std::vector<std::string>& names);
// Refuses a `list` of joints of which some have a name and others have none.
[[nodiscard]] Read<void> check_joint_names(const YamlNode& list, std::size_t joints,
                                           const std::vector<std::string>& names);

// "revolute" or "prismatic" under the key `type`.
[[nodiscard]] Read<JointType> read_joint_type(const YamlMap& map);

}  // namespace armsig::tool
