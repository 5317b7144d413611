// SPDX-License-Identifier: MIT
// The kinematics of a maker's or a solver's YAML: default_kinematics.yaml of the drivers of
// Universal Robots, and the opw_parameters of ROS-Industrial.
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/units.hpp"
#include "firmware/formats/yaml_map.hpp"
#include "firmware/host_tool/imports/import.hpp"
#include "firmware/host_tool/imports/plausible.hpp"

namespace armsig::tool {
namespace {

constexpr std::string_view kWithoutLimits =
    "the file has no limits: -180 to 180 degrees for every joint";

// A joint in the chain: reached from the link before it, then turned.
struct YamlJoint {
  Pose X_PJ;
  Vector3 axis_J = Vector3::UnitZ();
  double turned_rad = 0;  // at reading zero
};

// `X_KT`: the tip in the last link.
ImportedArm imported_from(std::span<const YamlJoint> joints, const Pose& X_KT,
                          std::vector<std::string> names) {
  AxisChain chain;
  Pose X_BK;
  for (const YamlJoint& joint : joints) {
    X_BK = X_BK * joint.X_PJ;
    ChainAxis axis;
    axis.limits = {-kPi, kPi};
    axis.direction_B = X_BK.R * joint.axis_J;
    axis.point_B = X_BK.p;
    chain.axes.push_back(axis);
    X_BK = X_BK * Pose{rotation_about(joint.axis_J, joint.turned_rad), Vector3::Zero()};
  }
  chain.X_BT = X_BK * X_KT;
  ImportedArm imported = described(chain, "imported arm", std::move(names));
  imported.notes.emplace_back(kWithoutLimits);
  return imported;
}

// The map that holds `key`, in `root` or however deep below: solvers' files name the group and the
// plugin around it. nullptr where there is none.
const YamlNode* map_with(const YamlNode& root, std::string_view key) {
  if (root.find(key) != nullptr) return &root;
  for (const YamlNode& item : root.items) {
    if (const YamlNode* found = map_with(item, key)) return found;
  }
  return nullptr;
}

// --- Universal Robots ---

constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kUrLinks{
    {{"shoulder", "shoulder_pan_joint"},
     {"upper_arm", "shoulder_lift_joint"},
     {"forearm", "elbow_joint"},
     {"wrist_1", "wrist_1_joint"},
     {"wrist_2", "wrist_2_joint"},
     {"wrist_3", "wrist_3_joint"}}};

Read<double> ur_number(const YamlMap& map, std::string_view key, double most,
                       std::string_view unit) {
  ARMSIG_TRY(number, map.number(key));
  if (std::abs(number) <= most) return number;
  return problem_at(*map.find(key), fmt::format("{} of {}: {}", key, map.name(), number),
                    std::string(unit));
}

Read<YamlJoint> ur_joint(const YamlMap& links, std::string_view link) {
  ARMSIG_TRY(node, links.require(link));
  ARMSIG_TRY(map, YamlMap::open(*node, std::string(link), {"x", "y", "z", "roll", "pitch", "yaw"}));
  YamlJoint joint;
  constexpr std::array kPlaces{"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    ARMSIG_TRY(number,
               ur_number(map, kPlaces.at(static_cast<std::size_t>(i)), kMostLength_m, "metres"));
    joint.X_PJ.p[i] = number;
  }
  ARMSIG_TRY(roll, ur_number(map, "roll", kMostAngle_rad, "radians"));
  ARMSIG_TRY(pitch, ur_number(map, "pitch", kMostAngle_rad, "radians"));
  ARMSIG_TRY(yaw, ur_number(map, "yaw", kMostAngle_rad, "radians"));
  joint.X_PJ.R = rotation_z(yaw) * rotation_about(Vector3::UnitY(), pitch) * rotation_x(roll);
  return joint;
}

Read<ImportedArm> ur_arm(const YamlNode& root) {
  const YamlNode* around = map_with(root, "kinematics");
  if (around == nullptr) {
    return problem_at(root, "there is no key kinematics",
                      "default_kinematics.yaml, or what calibration_correction of the drivers "
                      "writes");
  }
  std::vector<std::string> known{"hash"};
  std::vector<std::string> names;
  for (const auto& [link, name] : kUrLinks) {
    known.emplace_back(link);
    names.emplace_back(name);
  }
  ARMSIG_TRY(links, YamlMap::open(*around->find("kinematics"), "kinematics", known));
  std::array<YamlJoint, kUrLinks.size()> joints;
  for (std::size_t i = 0; i < kUrLinks.size(); ++i) {
    ARMSIG_TRY(joint, ur_joint(links, kUrLinks.at(i).first));
    joints.at(i) = joint;
  }
  ImportedArm imported = imported_from(joints, Pose{}, std::move(names));
  imported.notes.emplace_back(
      "the base is that of the controller of Universal Robots; base_link of its URDF is turned by "
      "180 degrees about z");
  return imported;
}

// --- Ortho-parallel basis and spherical wrist ---

constexpr std::string_view kOpwLengths = "opw_kinematics_geometric_parameters";
constexpr std::string_view kOpwOffsets = "opw_kinematics_joint_offsets";
constexpr std::string_view kOpwSigns = "opw_kinematics_joint_sign_corrections";

struct OpwParameters {
  double a1 = 0, a2 = 0, b = 0, c1 = 0, c2 = 0, c3 = 0, c4 = 0;
  std::array<double, 6> offset_rad{};
  std::array<double, 6> sign{1, 1, 1, 1, 1, 1};
};

Read<void> read_opw_lengths(const YamlNode& node, OpwParameters& opw) {
  const std::string name(kOpwLengths);
  ARMSIG_TRY(map, YamlMap::open(node, name, {"a1", "a2", "b", "c1", "c2", "c3", "c4"}));
  const std::array<std::pair<std::string_view, double*>, 7> lengths{{{"a1", &opw.a1},
                                                                     {"a2", &opw.a2},
                                                                     {"b", &opw.b},
                                                                     {"c1", &opw.c1},
                                                                     {"c2", &opw.c2},
                                                                     {"c3", &opw.c3},
                                                                     {"c4", &opw.c4}}};
  for (const auto& [key, length] : lengths) {
    ARMSIG_TRY(number, ur_number(map, key, kMostLength_m, "metres"));
    *length = number;
  }
  return {};
}

// Radians, or degrees as rosparam writes them: deg(-90.0).
Read<double> opw_angle(const YamlNode& node) {
  constexpr std::string_view kDegreesOf = "deg(";
  constexpr std::string_view kRadiansOf = "rad(";
  std::string_view text = trimmed(node.text);
  const bool in_degrees = text.starts_with(kDegreesOf);
  if ((in_degrees || text.starts_with(kRadiansOf)) && text.ends_with(')')) {
    text = trimmed(text.substr(kDegreesOf.size(), text.size() - kDegreesOf.size() - 1));
  }
  const auto number = parse_number(text);
  if (node.kind != YamlNode::Kind::kScalar || !number) {
    return problem_at(node, fmt::format("{}: {}", kOpwOffsets, in_quotes(node.text)),
                      "radians, or such as deg(-90)");
  }
  const double angle_rad = in_degrees ? radians(*number) : *number;
  if (std::abs(angle_rad) <= kMostAngle_rad) return angle_rad;
  return problem_at(node, fmt::format("{}: {}", kOpwOffsets, in_quotes(node.text)),
                    "radians, or such as deg(-90)");
}

Read<OpwParameters> read_opw(const YamlNode& around) {
  OpwParameters opw;
  if (auto read = read_opw_lengths(*around.find(kOpwLengths), opw); !read) {
    return std::unexpected(std::move(read).error());
  }
  if (const YamlNode* offsets = around.find(kOpwOffsets)) {
    ARMSIG_TRY(list, read_list(*offsets, kOpwOffsets, 6, 6));
    for (std::size_t i = 0; i < 6; ++i) {
      ARMSIG_TRY(angle_rad, opw_angle((*list)[i]));
      opw.offset_rad.at(i) = angle_rad;
    }
  }
  if (const YamlNode* signs = around.find(kOpwSigns)) {
    ARMSIG_TRY(list, read_list(*signs, kOpwSigns, 6, 6));
    for (std::size_t i = 0; i < 6; ++i) {
      ARMSIG_TRY(sign, read_number((*list)[i], kOpwSigns));
      if (std::abs(sign) != 1) {
        return problem_at((*list)[i], fmt::format("{}: {}", kOpwSigns, sign), "1 or -1");
      }
      opw.sign.at(i) = sign;
    }
  }
  return opw;
}

// Brandstötter, Angerer and Hofbaur (2014): stretched upwards at zero, z and y axes in turn. The
// angle of a joint is its reading times the sign, less the offset.
Read<ImportedArm> opw_arm(const YamlNode& root) {
  const YamlNode* around = map_with(root, kOpwLengths);
  if (around == nullptr) {
    return problem_at(root, fmt::format("there is no key {}", kOpwLengths),
                      "the parameters of opw_kinematics");
  }
  ARMSIG_TRY(opw, read_opw(*around));
  const std::array<Vector3, 6> places{Vector3::Zero(),       Vector3(opw.a1, 0, opw.c1),
                                      Vector3(0, 0, opw.c2), Vector3(opw.a2, opw.b, 0),
                                      Vector3(0, 0, opw.c3), Vector3::Zero()};
  constexpr std::array<bool, 6> kAboutY{false, true, true, false, true, false};
  std::array<YamlJoint, 6> joints;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Vector3 axis = kAboutY.at(i) ? Vector3::UnitY() : Vector3::UnitZ();
    joints.at(i) = {.X_PJ = {Matrix3::Identity(), places.at(i)},
                    .axis_J = opw.sign.at(i) * axis,
                    .turned_rad = -opw.sign.at(i) * opw.offset_rad.at(i)};
  }
  return imported_from(joints, {Matrix3::Identity(), Vector3(0, 0, opw.c4)}, {});
}

Read<ImportedArm> import_yaml(const std::string& path,
                              Read<ImportedArm> (*arm_of)(const YamlNode& root)) {
  ARMSIG_TRY(text, read_text_file(path));
  const auto parse = [&]() -> Read<ImportedArm> {
    ARMSIG_TRY(root, parse_yaml(text));
    return arm_of(root);
  };
  return in_file(path, parse());
}

}  // namespace

Read<ImportedArm> import_ur_yaml(const std::string& path) { return import_yaml(path, ur_arm); }

Read<ImportedArm> import_opw(const std::string& path) { return import_yaml(path, opw_arm); }

}  // namespace armsig::tool
