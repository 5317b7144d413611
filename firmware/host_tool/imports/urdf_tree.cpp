// SPDX-License-Identifier: MIT
#include "firmware/host_tool/imports/urdf_tree.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

using tinyxml2::XMLElement;

constexpr double kLeastAxis = 1e-9;
constexpr std::size_t kLongestPath = 256;

Read<Vector3> vector_attribute(const XMLElement& element, const char* name, const Vector3& absent) {
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
      return problem_at(element, fmt::format("{}: {}", name, why_not_a_number(word)),
                        word.find("${") == std::string_view::npos
                            ? "three numbers"
                            : "three numbers; xacro must be expanded before");
    }
    vector[i] = *number;
  }
  if (rest.find_first_not_of(" \t\r\n") != std::string_view::npos) {
    return problem_at(element, fmt::format("{}: {}", name, in_quotes(text)), "three numbers");
  }
  return vector;
}

Read<Pose> origin_of(const XMLElement& joint) {
  const XMLElement* origin = joint.FirstChildElement("origin");
  if (origin == nullptr) return Pose{};
  ARMSIG_TRY(xyz, vector_attribute(*origin, "xyz", Vector3::Zero()));
  ARMSIG_TRY(rpy, vector_attribute(*origin, "rpy", Vector3::Zero()));
  return Pose{rotation_z(rpy.z()) * rotation_about(Vector3::UnitY(), rpy.y()) * rotation_x(rpy.x()),
              xyz};
}

Read<UrdfMotion> motion_of(const XMLElement& joint) {
  const std::string type = attribute(joint, "type");
  if (type == "fixed") return UrdfMotion::kFixed;
  if (type == "revolute" || type == "continuous") return UrdfMotion::kTurns;
  if (type == "prismatic") return UrdfMotion::kSlides;
  return problem_at(
      joint,
      fmt::format("joint {} is of type {}", in_quotes(attribute(joint, "name")), in_quotes(type)),
      "revolute, continuous, prismatic or fixed");
}

Read<Vector3> axis_of(const XMLElement& joint) {
  const XMLElement* axis = joint.FirstChildElement("axis");
  if (axis == nullptr) return Vector3(Vector3::UnitX());  // the default of URDF
  ARMSIG_TRY(direction, vector_attribute(*axis, "xyz", Vector3::UnitX()));
  if (!(direction.norm() > kLeastAxis)) {
    return problem_at(
        *axis, fmt::format("axis of joint {} has no length", in_quotes(attribute(joint, "name"))),
        "a direction");
  }
  return Vector3(direction.normalized());
}

Read<UrdfJoint> read_joint(const XMLElement& element, std::size_t place) {
  if (auto name = check_urdf_name(element, "a joint"); !name) {
    return std::unexpected(std::move(name).error());
  }
  UrdfJoint joint;
  joint.element = &element;
  joint.place = place;
  joint.name = attribute(element, "name");
  ARMSIG_TRY(X_PJ, origin_of(element));
  ARMSIG_TRY(motion, motion_of(element));
  joint.X_PJ = X_PJ;
  joint.motion = motion;
  if (motion == UrdfMotion::kFixed) return joint;
  ARMSIG_TRY(axis_J, axis_of(element));
  joint.axis_J = axis_J;
  joint.mimic = element.FirstChildElement("mimic");
  return joint;
}

Read<void> find_link(const XMLElement& robot, const std::string& name) {
  std::vector<std::string> names;
  for (const XMLElement* link = robot.FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    names.push_back(attribute(*link, "name"));
  }
  if (std::ranges::find(names, name) != names.end()) return {};
  const std::string meant = nearest(name, names);
  return problem_at(robot, "there is no link " + in_quotes(name),
                    meant.empty() ? any_of(names) : meant);
}

std::string_view why_not_xml(tinyxml2::XMLError error) {
  switch (error) {
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "nothing is in it";
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "an element is not closed, or under another name";
    case tinyxml2::XML_ERROR_PARSING_ELEMENT:
      return "an element has no end or no name";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute is not NAME=\"VALUE\"";
    case tinyxml2::XML_ERROR_PARSING_TEXT:
      return "text that is in no element";
    case tinyxml2::XML_ERROR_PARSING_COMMENT:
      return "a comment has no end";
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      return "elements too deep inside each other";
    default:
      return "it can't be parsed";
  }
}

}  // namespace

std::unexpected<Problem> problem_at(const XMLElement& element, std::string what,
                                    std::string expected) {
  return problem_at(element.GetLineNum(), 0, std::move(what), std::move(expected));
}

std::string attribute(const XMLElement& element, const char* name) {
  const char* text = element.Attribute(name);
  return text == nullptr ? "" : text;
}

std::string child_attribute(const XMLElement& element, const char* child, const char* name) {
  const XMLElement* found = element.FirstChildElement(child);
  return found == nullptr ? "" : attribute(*found, name);
}

Read<double> number_attribute(const XMLElement& element, const char* name, double absent) {
  const char* text = element.Attribute(name);
  if (text == nullptr) return absent;
  const auto number = parse_number(trimmed(text));
  if (number) return *number;
  return problem_at(element, fmt::format("{}: {}", name, why_not_a_number(text)), "a number");
}

Read<void> check_urdf_name(const XMLElement& element, std::string_view whose) {
  if (const auto why = why_no_name(attribute(element, "name"))) {
    return problem_at(element, fmt::format("name of {}: {}", whose, *why),
                      std::string(kNameExpected));
  }
  return {};
}

Read<void> refuse_xacro(const XMLElement& robot, std::string expected) {
  for (const XMLElement* element = robot.FirstChildElement(); element != nullptr;
       element = element->NextSiblingElement()) {
    if (!std::string_view(element->Name()).starts_with("xacro:")) continue;
    return problem_at(*element, "xacro that is not expanded", std::move(expected));
  }
  return {};
}

Read<const XMLElement*> parse_urdf(std::string_view text, tinyxml2::XMLDocument& document) {
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    return problem_at(document.ErrorLineNum(), 0,
                      fmt::format("not XML: {}", why_not_xml(document.ErrorID())),
                      "a URDF file; xacro must be expanded before");
  }
  const XMLElement* robot = document.FirstChildElement("robot");
  if (robot != nullptr) return robot;
  return problem_at(1, 0, "there is no robot in the file", "<robot name=...> as its root");
}

const XMLElement* urdf_joint(const XMLElement& robot, std::string_view name) {
  for (const XMLElement* joint = robot.FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    if (attribute(*joint, "name") == name) return joint;
  }
  return nullptr;
}

Read<std::vector<UrdfJoint>> urdf_path(const XMLElement& robot, const std::string& base,
                                       const std::string& tip) {
  for (const std::string& name : {base, tip}) {
    if (auto found = find_link(robot, name); !found) {
      return std::unexpected(std::move(found).error());
    }
  }
  // Joints hang on their children: from the tip upwards there is one way only.
  std::vector<UrdfJoint> path;
  for (std::string link = tip; link != base;) {
    const XMLElement* above = nullptr;
    std::size_t place = 0;
    for (const XMLElement* joint = robot.FirstChildElement("joint"); joint != nullptr;
         joint = joint->NextSiblingElement("joint")) {
      above = child_attribute(*joint, "child", "link") == link ? joint : nullptr;
      if (above != nullptr) break;
      ++place;
    }
    if (above == nullptr || path.size() > kLongestPath) {
      return problem_at(
          robot, fmt::format("link {} is not below link {}", in_quotes(tip), in_quotes(base)),
          "a tip link that hangs on the base link");
    }
    ARMSIG_TRY(joint, read_joint(*above, place));
    path.push_back(joint);
    link = child_attribute(*above, "parent", "link");
  }
  std::ranges::reverse(path);
  return path;
}

}  // namespace armsig::tool
