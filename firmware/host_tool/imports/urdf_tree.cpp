// SPDX-License-Identifier: MIT
#include "firmware/host_tool/imports/urdf_tree.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/imports/plausible.hpp"

namespace armsig::tool {
namespace {

using tinyxml2::XMLElement;

constexpr double kLeastAxis = 1e-9;
constexpr std::size_t kLongestPath = 256;
constexpr std::size_t kMostAttributes = 64;
constexpr std::array<std::pair<const char*, std::string_view>, 4> kOtherFormats{
    {{"mujoco", "MJCF, a model of MuJoCo"},
     {"mujocoinclude", "MJCF, a part of a model of MuJoCo"},
     {"sdf", "SDF, a model of Gazebo"},
     {"COLLADA", "COLLADA, a scene"}}};

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
  if (!(rpy.cwiseAbs().maxCoeff() <= kMostAngle_rad)) {
    return problem_at(*origin, fmt::format("rpy: {}", in_quotes(attribute(*origin, "rpy"))),
                      "radians");
  }
  if (!(xyz.norm() <= kMostLength_m)) {
    return problem_at(*origin, fmt::format("xyz: {}", in_quotes(attribute(*origin, "xyz"))),
                      "metres");
  }
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

bool is_xacro(const XMLElement& element) {
  return std::string_view(element.Name()).starts_with("xacro:");
}

// The first element of xacro inside of `element`, however deep; nullptr where there is none. The
// parser lets no element be deeper than it can go.
const XMLElement* xacro_in(const XMLElement& element) {
  for (const XMLElement* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    if (is_xacro(*child)) return child;
    if (const XMLElement* found = xacro_in(*child)) return found;
  }
  return nullptr;
}

Read<UrdfJoint> read_joint(const XMLElement& element, std::size_t place) {
  if (auto name = check_urdf_name(element, "a joint"); !name) {
    return std::unexpected(std::move(name).error());
  }
  if (const XMLElement* xacro = xacro_in(element)) {
    return problem_at(*xacro,
                      fmt::format("xacro that is not expanded, in joint {}",
                                  in_quotes(attribute(element, "name"))),
                      "xacro FILE -o arm.urdf first");
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

struct JointAbove {
  const XMLElement* element = nullptr;  // none: the link hangs on nothing
  std::size_t place = 0;                // among the joints of the robot, from 0
};

// The one joint whose child the link is.
Read<JointAbove> joint_above(const XMLElement& robot, const std::string& link) {
  JointAbove above;
  std::size_t place = 0;
  for (const XMLElement* joint = robot.FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint"), ++place) {
    if (child_attribute(*joint, "child", "link") != link) continue;
    if (above.element != nullptr) {
      return problem_at(*joint,
                        fmt::format("link {} hangs on joint {} and on joint {}", in_quotes(link),
                                    in_quotes(attribute(*above.element, "name")),
                                    in_quotes(attribute(*joint, "name"))),
                        "one joint above each link");
    }
    above = {joint, place};
  }
  return above;
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

// The end of what begins at `at` with "<": a comment, text taken as it is, or an element, of which
// `values` is how many values in quotes it has.
std::size_t end_of_markup(std::string_view text, std::size_t at, std::size_t& values) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kWithoutAttributes{
      {{"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}}};
  for (const auto& [begin, end] : kWithoutAttributes) {
    if (text.substr(at).starts_with(begin)) return text.find(end, at + begin.size());
  }
  values = 0;
  while ((at = text.find_first_of("\"'>", at)) != std::string_view::npos && text[at] != '>') {
    ++values;
    at = text.find(text[at], at + 1);
    if (at == std::string_view::npos) break;
    ++at;
  }
  return at;
}

// The parser compares every attribute of an element with all before it: time by their square.
Read<void> check_attributes(std::string_view text) {
  for (std::size_t at = text.find('<'); at != std::string_view::npos;) {
    std::size_t values = 0;
    const std::size_t end = end_of_markup(text, at, values);
    if (values > kMostAttributes) {
      const auto line = 1 + std::ranges::count(text.substr(0, at), '\n');
      return problem_at(static_cast<int>(line), 0,
                        fmt::format("more than {} attributes in one element", kMostAttributes),
                        "a URDF file; xacro must be expanded before");
    }
    at = end == std::string_view::npos ? end : text.find('<', end);
  }
  return {};
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
  constexpr std::array<std::string_view, 3> kDefinitions{"xacro:property", "xacro:arg",
                                                         "xacro:macro"};
  for (const XMLElement* element = robot.FirstChildElement(); element != nullptr;
       element = element->NextSiblingElement()) {
    if (!is_xacro(*element)) continue;
    if (std::ranges::find(kDefinitions, element->Name()) != kDefinitions.end()) continue;
    return problem_at(*element, "xacro that is not expanded", std::move(expected));
  }
  return {};
}

Read<const XMLElement*> parse_urdf(std::string_view text, tinyxml2::XMLDocument& document) {
  if (auto few = check_attributes(text); !few) return std::unexpected(std::move(few).error());
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    return problem_at(document.ErrorLineNum(), 0,
                      fmt::format("not XML: {}", why_not_xml(document.ErrorID())),
                      "a URDF file; xacro must be expanded before");
  }
  const XMLElement* robot = document.FirstChildElement("robot");
  if (robot != nullptr) return robot;
  for (const auto& [root, format] : kOtherFormats) {
    const XMLElement* other = document.FirstChildElement(root);
    if (other == nullptr) continue;
    return problem_at(*other, fmt::format("the file is {}", format),
                      "a URDF file of the same arm: its maker's, or what a converter makes of it");
  }
  return problem_at(1, 0, "there is no robot in the file", "<robot name=...> as its root");
}

Pose moved_by(const UrdfJoint& joint, double reading) {
  if (joint.motion == UrdfMotion::kTurns) {
    return {rotation_about(joint.axis_J, reading), Vector3::Zero()};
  }
  return {Matrix3::Identity(), joint.axis_J * reading};
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
    ARMSIG_TRY(above, joint_above(robot, link));
    if (path.size() == kLongestPath) {
      return problem_at(robot,
                        fmt::format("more than {} joints between link {} and link {}", kLongestPath,
                                    in_quotes(tip), in_quotes(base)),
                        "a chain of links without a loop, of at most as many joints");
    }
    if (above.element == nullptr) {
      return problem_at(
          robot, fmt::format("link {} is not below link {}", in_quotes(tip), in_quotes(base)),
          "a tip link that hangs on the base link");
    }
    ARMSIG_TRY(joint, read_joint(*above.element, above.place));
    path.push_back(joint);
    link = child_attribute(*above.element, "parent", "link");
  }
  std::ranges::reverse(path);
  return path;
}

}  // namespace armsig::tool
