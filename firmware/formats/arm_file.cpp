// SPDX-License-Identifier: MIT
#include "firmware/formats/arm_file.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/base/couplings.hpp"
#include "core/base/error.hpp"
#include "core/base/joint_range.hpp"
#include "core/base/pose.hpp"
#include "firmware/formats/mounting.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/yaml_map.hpp"

namespace armsig::tool {
namespace {

std::vector<std::string> joint_keys() {
  std::vector<std::string> known{"name", "type"};
  add_names(known, "theta", Dimension::kAngle);
  add_names(known, "d", Dimension::kLength);
  add_names(known, "a", Dimension::kLength);
  add_names(known, "alpha", Dimension::kAngle);
  add_limit_names(known);
  add_names(known, "sweep_at", Dimension::kAngle);
  add_names(known, "sweep_at", Dimension::kLength);
  return known;
}

Read<DhJoint> read_dh(const YamlMap& map) {
  ARMSIG_TRY(type, read_joint_type(map));
  ARMSIG_TRY(theta_rad, map.quantity("theta", Dimension::kAngle));
  ARMSIG_TRY(d_m, map.quantity("d", Dimension::kLength));
  ARMSIG_TRY(a_m, map.quantity("a", Dimension::kLength));
  ARMSIG_TRY(alpha_rad, map.quantity("alpha", Dimension::kAngle));
  return DhJoint{type, theta_rad, d_m, a_m, alpha_rad};
}

Read<JointCoupling> read_coupling(const YamlNode& node, const DhRows& joints) {
  ARMSIG_TRY(map, YamlMap::open(node, "a coupling", {"joint", "from", "ratio"}));
  const int last = static_cast<int>(joints.size());
  ARMSIG_TRY(joint, map.integer("joint", 1, last));
  ARMSIG_TRY(from, map.integer("from", 1, last));
  ARMSIG_TRY(ratio, map.number("ratio"));
  const JointCoupling coupling{static_cast<std::size_t>(joint - 1),
                               static_cast<std::size_t>(from - 1), ratio};
  if (joint == from) {
    return problem_at(node, fmt::format("joint {} is coupled to itself", joint), "another joint");
  }
  // A ratio between a length and an angle would need a unit, and its key names none.
  if (joints[coupling.joint].type != joints[coupling.from].type) {
    return problem_at(
        node,
        fmt::format("joint {} is {}, joint {} is {}", joint, word_of(joints[coupling.joint].type),
                    from, word_of(joints[coupling.from].type)),
        "a coupling between joints of one type");
  }
  return coupling;
}

// Far enough to let everything through that is no wrong unit; an arm that may differ more needs no
// drawing.
Read<double> read_deviation(const YamlQuantity& given) {
  ARMSIG_TRY(value, read_number(*given.value, given.key->text));
  if (value > 0) return given.unit.to_si(value);
  return problem_at(*given.value, fmt::format("{}: {} is not positive", given.key->text, value),
                    "how far an arm may be from the nominal model");
}

Read<ArmLimits> read_deviations(const YamlNode& node) {
  std::vector<std::string> known;
  add_names(known, "tilt", Dimension::kAngle);
  add_names(known, "shift", Dimension::kLength);
  add_names(known, "zero", Dimension::kAngle);
  ARMSIG_TRY(map, YamlMap::open(node, "deviations", known));
  ArmLimits limits;
  ARMSIG_TRY(tilt, map.find_quantity("tilt", Dimension::kAngle));
  ARMSIG_TRY(shift, map.find_quantity("shift", Dimension::kLength));
  ARMSIG_TRY(zero, map.find_quantity("zero", Dimension::kAngle));
  if (tilt) {
    ARMSIG_TRY(tilt_rad, read_deviation(*tilt));
    limits.tilt_rad = tilt_rad;
  }
  if (shift) {
    ARMSIG_TRY(shift_m, read_deviation(*shift));
    limits.least_shift_m = shift_m;
    limits.shift_share = 0;
  }
  if (zero) {
    ARMSIG_TRY(zero_rad, read_deviation(*zero));
    limits.zero_rad = zero_rad;
  }
  return limits;
}

// The reading of the signature configuration, inside the limits.
Read<void> read_sweep_at(const YamlMap& map, JointType type, const JointLimits& limits,
                         JointVector& sweep_at) {
  const JointType other =
      type == JointType::kRevolute ? JointType::kPrismatic : JointType::kRevolute;
  ARMSIG_TRY(wrong, map.find_quantity("sweep_at", dimension_of(other)));
  if (wrong) {
    return problem_at(
        *wrong->key,
        fmt::format("{} on {}, which is {}", wrong->key->text, map.name(), word_of(type)),
        any_of(names_of("sweep_at", dimension_of(type))));
  }
  ARMSIG_TRY(found, map.find_quantity("sweep_at", dimension_of(type)));
  if (!found) return {};
  ARMSIG_TRY(number, read_number(*found->value, found->key->text));
  const double reading = found->unit.to_si(number);
  if (!(reading >= limits.lower && reading <= limits.upper)) {
    return problem_at(*found->value,
                      fmt::format("{} of {}: {:g}", found->key->text, map.name(), number),
                      "a reading inside the limits");
  }
  sweep_at.push_back(reading);
  return {};
}

Read<void> read_joint(const YamlNode& node, ArmDescription& description) {
  Arm& arm = description.arm;
  ARMSIG_TRY(map,
             YamlMap::open(node, fmt::format("joint {}", arm.joints.size() + 1), joint_keys()));
  if (auto named = read_joint_name(map, description.joint_names); !named) return named;
  ARMSIG_TRY(joint, read_dh(map));
  ARMSIG_TRY(limits, read_limits(map, joint.type));
  if (auto done = read_sweep_at(map, joint.type, limits, description.sweep_at); !done) return done;
  arm.joints.push_back(joint);
  arm.limits.push_back(limits);
  return {};
}

Read<void> read_arm_joints(const YamlMap& map, ArmDescription& description) {
  ARMSIG_TRY(list_node, map.require("joints"));
  ARMSIG_TRY(list, read_list(*list_node, "joints", 1, kMaxJoints));
  for (const YamlNode& node : *list) {
    if (auto done = read_joint(node, description); !done) return done;
  }
  const std::size_t joints = description.arm.joints.size();
  const std::size_t told = description.sweep_at.size();
  if (told != 0 && told != joints) {
    return problem_at(*list_node, fmt::format("{} of {} joints have a sweep_at", told, joints),
                      "a sweep_at for every joint, or for none");
  }
  return check_joint_names(*list_node, joints, description.joint_names);
}

Read<ArmDescription> arm_from(const YamlNode& root) {
  if (auto tag = check_tag(root, kArmTag); !tag) return std::unexpected(std::move(tag).error());
  std::vector<std::string> known{"armsig", "name", "joints", "coupling", "deviations"};
  add_mounting_keys(known);
  ARMSIG_TRY(map, YamlMap::open(root, "the arm", known));
  ArmDescription description;
  ARMSIG_TRY(name, map.name_under("name"));
  description.name = name;
  if (auto done = read_arm_joints(map, description); !done) {
    return std::unexpected(std::move(done).error());
  }
  if (const YamlNode* coupling = map.find("coupling")) {
    ARMSIG_TRY(couplings, read_couplings(*coupling, description.arm.joints));
    description.arm.couplings = couplings;
  }
  if (const YamlNode* deviations = map.find("deviations")) {
    ARMSIG_TRY(limits, read_deviations(*deviations));
    description.limits = limits;
  }
  ARMSIG_TRY(mounting, read_mounting(map));
  description.mounting = mounting;
  description.arm.up_0 = -clearance::gravity_B(description.arm, mounting);
  return description;
}

// `limits: none`, of a joint that turns without end.
Read<JointLimits> read_no_limits(const YamlMap& map, const YamlNode& none, JointType type) {
  const std::string expected = any_of(names_of("limits", dimension_of(type)));
  if (none.kind != YamlNode::Kind::kScalar || none.text != "none") {
    return problem_at(none, fmt::format("limits of {} have no unit", map.name()),
                      type == JointType::kRevolute
                          ? expected + "; or limits: none, of a joint that turns without end"
                          : expected);
  }
  if (type == JointType::kPrismatic) {
    return problem_at(none, fmt::format("{} is prismatic and has no limits", map.name()), expected);
  }
  ARMSIG_TRY(stated, map.find_quantity("limits", Dimension::kAngle));
  if (!stated) return kNoLimits;
  return problem_at(none, fmt::format("limits and {} of {}", stated->key->text, map.name()),
                    "one of the two");
}

// The key `name` and its value, with what stands before the next key.
std::string name_entry(const std::vector<std::string>& names, std::size_t joint) {
  return names.empty() ? "" : fmt::format("name: {}, ", yaml_quoted(names[joint]));
}

// The key `sweep_at` and its value, with what stands after the key before it.
std::string sweep_at_entry(const ArmDescription& description, std::size_t joint) {
  if (description.sweep_at.empty()) return {};
  return fmt::format(", sweep_at_{}: {}", si_suffix(description.arm.joints[joint].type),
                     number_text(description.sweep_at[joint]));
}

}  // namespace

Read<void> read_joint_name(const YamlMap& map, std::vector<std::string>& names) {
  if (map.find("name") == nullptr) return {};
  ARMSIG_TRY(name, map.name_under("name"));
  if (std::ranges::find(names, name) != names.end()) {
    return problem_at(*map.find("name"), "two joints are called " + in_quotes(name),
                      "a name of its own for each");
  }
  names.push_back(name);
  return {};
}

Read<void> check_joint_names(const YamlNode& list, std::size_t joints,
                             const std::vector<std::string>& names) {
  if (names.empty() || names.size() == joints) return {};
  return problem_at(list, fmt::format("{} of {} joints have a name", names.size(), joints),
                    "a name for every joint, or for none");
}

Read<JointType> read_joint_type(const YamlMap& map) {
  ARMSIG_TRY(node, map.require("type"));
  if (node->text == "revolute") return JointType::kRevolute;
  if (node->text == "prismatic") return JointType::kPrismatic;
  return problem_at(*node, fmt::format("type of {}: {}", map.name(), in_quotes(node->text)),
                    "revolute or prismatic");
}

void add_limit_names(std::vector<std::string>& known) {
  known.emplace_back("limits");
  add_names(known, "limits", Dimension::kAngle);
  add_names(known, "limits", Dimension::kLength);
}

std::string limits_text(JointType type, const JointLimits& limits) {
  if (is_endless(limits)) return "limits: none";
  return fmt::format("limits_{}: [{}, {}]", si_suffix(type), number_text(limits.lower),
                     number_text(limits.upper));
}

Read<JointLimits> read_limits(const YamlMap& map, JointType type) {
  if (const YamlNode* none = map.find("limits")) return read_no_limits(map, *none, type);
  const Dimension dimension = dimension_of(type);
  const Dimension other = type == JointType::kRevolute ? Dimension::kLength : Dimension::kAngle;
  const std::string expected = any_of(names_of("limits", dimension));
  ARMSIG_TRY(wrong, map.find_quantity("limits", other));
  if (wrong) {
    return problem_at(
        *wrong->key,
        fmt::format("{} on {}, which is {}", wrong->key->text, map.name(), word_of(type)),
        expected);
  }
  ARMSIG_TRY(found, map.find_quantity("limits", dimension));
  if (!found && type == JointType::kRevolute) return JointLimits{-kPi, kPi};
  if (!found) {
    return problem_at(map.node(), fmt::format("{} is prismatic and has no limits", map.name()),
                      expected);
  }
  ARMSIG_TRY(values, read_numbers(*found->value, found->key->text, 2));
  if (!(values[0] < values[1])) {
    return problem_at(*found->value,
                      fmt::format("{} of {}: {} is not below {}", found->key->text, map.name(),
                                  values[0], values[1]),
                      "the lower limit first");
  }
  return JointLimits{found->unit.to_si(values[0]), found->unit.to_si(values[1])};
}

Read<JointCouplings> read_couplings(const YamlNode& list, const DhRows& joints) {
  JointCouplings couplings;
  ARMSIG_TRY(items, read_list(list, "coupling", 0, kMaxJoints));
  for (const YamlNode& node : *items) {
    ARMSIG_TRY(coupling, read_coupling(node, joints));
    for (const JointCoupling& earlier : couplings) {
      if (earlier.joint != coupling.joint || earlier.from != coupling.from) continue;
      return problem_at(node,
                        fmt::format("the coupling of joint {} from joint {} is given twice",
                                    coupling.joint + 1, coupling.from + 1),
                        "each pair once");
    }
    couplings.push_back(coupling);
    if (leads_back(couplings, coupling.joint)) {
      return problem_at(
          node, fmt::format("joint {} hangs, through others, on itself", coupling.joint + 1),
          "couplings that lead from inner joints to outer ones, or the other way");
    }
  }
  return couplings;
}

std::string couplings_text(const JointCouplings& couplings) {
  if (couplings.empty()) return {};
  std::string text = "coupling:\n";
  for (const JointCoupling& coupling : couplings) {
    text += fmt::format("  - {{joint: {}, from: {}, ratio: {}}}\n", coupling.joint + 1,
                        coupling.from + 1, number_text(coupling.ratio));
  }
  return text;
}

Read<ArmDescription> parse_arm(std::string_view text, std::string_view file) {
  const auto parse = [&]() -> Read<ArmDescription> {
    ARMSIG_TRY(root, parse_yaml(text));
    return arm_from(root);
  };
  return in_file(file, parse());
}

Read<ArmDescription> read_arm_file(const std::string& path) {
  ARMSIG_TRY(text, read_text_file(path));
  return parse_arm(text, path);
}

std::string arm_text(const ArmDescription& description) {
  const Arm& arm = description.arm;
  std::string text =
      fmt::format("armsig: {}\nname: {}\njoints:\n", kArmTag, yaml_quoted(description.name));
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const DhJoint& joint = arm.joints[i];
    text += fmt::format(
        "  - {{{}type: {}, theta_rad: {}, d_m: {}, a_m: {}, alpha_rad: {}, {}{}}}\n",
        name_entry(description.joint_names, i), word_of(joint.type), number_text(joint.theta_rad),
        number_text(joint.d_m), number_text(joint.a_m), number_text(joint.alpha_rad),
        limits_text(joint.type, arm.limits[i]), sweep_at_entry(description, i));
  }
  return text + couplings_text(arm.couplings) + mounting_text(description.mounting);
}

Read<void> write_arm_file(const std::string& path, const ArmDescription& description) {
  const std::string text = arm_text(description);
  if (auto check = parse_arm(text, path); !check) {
    return std::unexpected(std::move(check).error());
  }
  return write_text_file(path, text);
}

Read<std::string> read_tag(const std::string& path) {
  ARMSIG_TRY(text, read_text_file(path, kLargestSignature));
  const auto parse = [&]() -> Read<std::string> {
    ARMSIG_TRY(root, parse_yaml(text));
    const YamlNode* tag = root.find("armsig");
    if (tag == nullptr || tag->kind != YamlNode::Kind::kScalar) {
      return problem_at(root, "the file does not say what it is",
                        "armsig: arm/1 or armsig: signature/1 as its first line");
    }
    return tag->text;
  };
  return in_file(path, parse());
}

}  // namespace armsig::tool
