// SPDX-License-Identifier: MIT
#include <tinyxml2.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/host_tool/imports/import.hpp"

namespace armsig::tool {
namespace {

using tinyxml2::XMLElement;

constexpr double kLeastAxis = 1e-9;
constexpr double kSameAxis = 1e-9;  // metres and radians

std::string attribute(const XMLElement& element, const char* name) {
  const char* text = element.Attribute(name);
  return text == nullptr ? "" : text;
}

// The attribute of a child element: <parent link="base"/>.
std::string child_attribute(const XMLElement& element, const char* child, const char* name) {
  const XMLElement* found = element.FirstChildElement(child);
  return found == nullptr ? "" : attribute(*found, name);
}

std::string called(const XMLElement& joint) {
  return "joint " + in_quotes(attribute(joint, "name"));
}

std::unexpected<Problem> at(const XMLElement& element, std::string what, std::string expected) {
  return problem_at(element.GetLineNum(), 0, std::move(what), std::move(expected));
}

Read<Vector3> read_vector(const XMLElement& element, const char* name, const Vector3& absent) {
  const char* text = element.Attribute(name);
  if (text == nullptr) return absent;
  Vector3 vector;
  std::string_view rest = text;
  for (int i = 0; i < 3; ++i) {
    const std::size_t start = rest.find_first_not_of(" \t\r\n");
    rest = start == std::string_view::npos ? std::string_view{} : rest.substr(start);
    const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r\n"));
    rest = rest.substr(word.size());
    const auto number = parse_number(word);
    if (!number) {
      return at(element, fmt::format("{}: {}", name, why_not_a_number(word)), "three numbers");
    }
    vector[i] = *number;
  }
  if (rest.find_first_not_of(" \t\r\n") != std::string_view::npos) {
    return at(element, fmt::format("{}: {}", name, in_quotes(text)), "three numbers");
  }
  return vector;
}

Read<double> read_number(const XMLElement& element, const char* name, double absent) {
  const char* text = element.Attribute(name);
  if (text == nullptr) return absent;
  const auto number = parse_number(trimmed(text));
  if (!number) return at(element, fmt::format("{}: {}", name, why_not_a_number(text)), "a number");
  return *number;
}

Read<Pose> read_origin(const XMLElement& joint) {
  const XMLElement* origin = joint.FirstChildElement("origin");
  if (origin == nullptr) return Pose{};
  ARMSIG_TRY(xyz, read_vector(*origin, "xyz", Vector3::Zero()));
  ARMSIG_TRY(rpy, read_vector(*origin, "rpy", Vector3::Zero()));
  return Pose{rotation_z(rpy.z()) * rotation_about(Vector3::UnitY(), rpy.y()) * rotation_x(rpy.x()),
              xyz};
}

Read<JointLimits> read_joint_limits(const XMLElement& joint, std::string_view type) {
  if (type == "continuous") return JointLimits{-kPi, kPi};
  const XMLElement* limit = joint.FirstChildElement("limit");
  if (limit == nullptr) {
    return at(joint, called(joint) + " has no limit", "<limit lower=... upper=...>");
  }
  ARMSIG_TRY(lower, read_number(*limit, "lower", 0));
  ARMSIG_TRY(upper, read_number(*limit, "upper", 0));
  if (!(lower < upper)) {
    return at(
        *limit,
        fmt::format("limit of {}: lower {} is not below upper {}", called(joint), lower, upper),
        "lower below upper");
  }
  return JointLimits{lower, upper};
}

// The name of a robot or joint becomes part of files and messages.
Read<void> check_name(const XMLElement& element, std::string_view whose) {
  if (const auto why = why_no_name(attribute(element, "name"))) {
    return at(element, fmt::format("name of {}: {}", whose, *why), std::string(kNameExpected));
  }
  return {};
}

// A joint that follows another by mimic, waiting for the joint about the same axis.
struct Follower {
  const XMLElement* element = nullptr;
  ChainAxis axis;
  std::string of;
  double ratio = 0;
};

class ChainReader {
 public:
  ChainReader(const XMLElement& robot, std::string base, std::string tip)
      : robot_(robot), base_(std::move(base)), tip_(std::move(tip)) {}

  Read<ImportedArm> read() {
    if (auto name = check_name(robot_, "the robot"); !name) {
      return std::unexpected(std::move(name).error());
    }
    ARMSIG_TRY(path, path_of_joints());
    for (const XMLElement* joint : path) {
      if (auto added = add(*joint); !added) return std::unexpected(std::move(added).error());
    }
    if (!followers_.empty()) {
      return at(*followers_[0].element,
                called(*followers_[0].element) + " mimics another joint by itself",
                "a mimic joint only where the next joint turns about the same axis: a coupling");
    }
    if (chain_.axes.empty()) {
      return at(robot_,
                fmt::format("no joint moves between {} and {}", in_quotes(base_), in_quotes(tip_)),
                "links with moving joints between them");
    }
    chain_.X_BT = X_BK_;
    DrawnChain drawing = drawn(chain_);
    return ImportedArm{
        {attribute(robot_, "name"), drawing.arm}, std::move(names_), std::move(drawing.notes)};
  }

 private:
  // The joints from base to tip, found from the tip upwards.
  [[nodiscard]] Read<std::vector<const XMLElement*>> path_of_joints() const {
    for (const std::string& name : {base_, tip_}) {
      if (auto found = find_link(name); !found) return std::unexpected(std::move(found).error());
    }
    std::vector<const XMLElement*> path;
    for (std::string link = tip_; link != base_;) {
      const XMLElement* joint = joint_to(link);
      if (joint == nullptr || path.size() > kLongestPath) {
        return at(robot_,
                  fmt::format("link {} is not below link {}", in_quotes(tip_), in_quotes(base_)),
                  "a tip link that hangs on the base link");
      }
      path.push_back(joint);
      link = child_attribute(*joint, "parent", "link");
    }
    std::ranges::reverse(path);
    return path;
  }

  [[nodiscard]] Read<void> find_link(const std::string& name) const {
    std::vector<std::string> names;
    for (const XMLElement* link = robot_.FirstChildElement("link"); link != nullptr;
         link = link->NextSiblingElement("link")) {
      names.push_back(attribute(*link, "name"));
    }
    if (std::ranges::find(names, name) != names.end()) return {};
    const std::string meant = nearest(name, names);
    return at(robot_, "there is no link " + in_quotes(name), meant.empty() ? any_of(names) : meant);
  }

  [[nodiscard]] const XMLElement* joint_to(const std::string& link) const {
    for (const XMLElement* joint = robot_.FirstChildElement("joint"); joint != nullptr;
         joint = joint->NextSiblingElement("joint")) {
      if (child_attribute(*joint, "child", "link") == link) return joint;
    }
    return nullptr;
  }

  Read<void> add(const XMLElement& joint) {
    if (auto name = check_name(joint, "a joint"); !name) return name;
    ARMSIG_TRY(X_PJ, read_origin(joint));
    X_BK_ = X_BK_ * X_PJ;
    const std::string type = attribute(joint, "type");
    if (type == "fixed") return {};
    if (type != "revolute" && type != "continuous" && type != "prismatic") {
      return at(joint, fmt::format("{} is of type {}", called(joint), in_quotes(type)),
                "revolute, continuous, prismatic or fixed");
    }
    ChainAxis axis;
    axis.type = type == "prismatic" ? JointType::kPrismatic : JointType::kRevolute;
    ARMSIG_TRY(direction, read_direction(joint));
    axis.direction_B = X_BK_.R * direction;
    axis.point_B = X_BK_.p;
    if (const XMLElement* mimic = joint.FirstChildElement("mimic")) {
      return add_follower(joint, *mimic, axis);
    }
    ARMSIG_TRY(limits, read_joint_limits(joint, type));
    axis.limits = limits;
    if (chain_.axes.size() == kMaxJoints) {
      return at(joint, fmt::format("more than {} moving joints", kMaxJoints),
                fmt::format("at most {} between base and tip", kMaxJoints));
    }
    chain_.axes.push_back(axis);
    names_.push_back(attribute(joint, "name"));
    return couple(axis);
  }

  static Read<Vector3> read_direction(const XMLElement& joint) {
    const XMLElement* axis = joint.FirstChildElement("axis");
    if (axis == nullptr) return Vector3(Vector3::UnitX());  // the default of URDF
    ARMSIG_TRY(direction, read_vector(*axis, "xyz", Vector3::UnitX()));
    if (!(direction.norm() > kLeastAxis)) {
      return at(*axis, "axis of " + called(joint) + " has no length", "a direction");
    }
    return Vector3(direction.normalized());
  }

  Read<void> add_follower(const XMLElement& joint, const XMLElement& mimic, const ChainAxis& axis) {
    ARMSIG_TRY(ratio, read_number(mimic, "multiplier", 1));
    ARMSIG_TRY(offset, read_number(mimic, "offset", 0));
    if (offset != 0) {
      return at(mimic, called(joint) + " mimics with an offset", "offset 0");
    }
    followers_.push_back({&joint, axis, attribute(mimic, "joint"), ratio});
    return {};
  }

  // Joint `axis` has just been added: the followers before it must turn about its axis.
  Read<void> couple(const ChainAxis& axis) {
    for (const Follower& follower : followers_) {
      const double turned = follower.axis.direction_B.cross(axis.direction_B).norm();
      const double apart = axis.direction_B.cross(follower.axis.point_B - axis.point_B).norm();
      const auto from = std::ranges::find(names_, follower.of);
      if (turned > kSameAxis || apart > kSameAxis || from == names_.end() ||
          from + 1 == names_.end()) {
        return at(*follower.element,
                  called(*follower.element) + " mimics a joint and is no coupling of the next one",
                  "a mimic of an earlier joint about the axis of the joint after it");
      }
      const double sense = follower.axis.direction_B.dot(axis.direction_B) > 0 ? 1 : -1;
      chain_.couplings.push_back({chain_.axes.size() - 1,
                                  static_cast<std::size_t>(from - names_.begin()),
                                  sense * follower.ratio});
    }
    followers_.clear();
    return {};
  }

  static constexpr std::size_t kLongestPath = 256;

  const XMLElement& robot_;
  std::string base_, tip_;
  Pose X_BK_;  // the link reached, at readings zero
  AxisChain chain_;
  std::vector<std::string> names_;
  std::vector<Follower> followers_;
};

}  // namespace

Read<ImportedArm> import_urdf(const std::string& path, const std::string& base,
                              const std::string& tip) {
  ARMSIG_TRY(text, read_text_file(path, kLargestUrdf));
  const auto parse = [&]() -> Read<ImportedArm> {
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
      return problem_at(document.ErrorLineNum(), 0,
                        fmt::format("not XML: {}", document.ErrorName()),
                        "a URDF file; xacro must be expanded before");
    }
    const XMLElement* robot = document.FirstChildElement("robot");
    if (robot == nullptr) {
      return problem_at(1, 0, "there is no robot in the file", "<robot name=...> as its root");
    }
    return ChainReader(*robot, base, tip).read();
  };
  return in_file(path, parse());
}

}  // namespace armsig::tool
