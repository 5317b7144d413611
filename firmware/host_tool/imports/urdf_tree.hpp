// SPDX-License-Identifier: MIT
// The joints of a URDF file from a base link to a tip link, as the file has them.
#pragma once

#include <tinyxml2.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/pose.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

enum class UrdfMotion : std::uint8_t { kFixed, kTurns, kSlides };

struct UrdfJoint {
  const tinyxml2::XMLElement* element = nullptr;
  std::size_t place = 0;  // among the joints of the robot, from 0
  std::string name;
  UrdfMotion motion = UrdfMotion::kFixed;
  Pose X_PJ;                                    // in the parent link, at reading zero
  Vector3 axis_J = Vector3::UnitX();            // unit; of a joint that moves
  const tinyxml2::XMLElement* mimic = nullptr;  // of a joint that follows another
};

// The robot of a document that was parsed from `text`.
[[nodiscard]] Read<const tinyxml2::XMLElement*> parse_urdf(std::string_view text,
                                                           tinyxml2::XMLDocument& document);

// Refuses a robot with xacro in it that may stand for joints, which must be expanded before;
// `expected`: how. What only defines something stands for none.
[[nodiscard]] Read<void> refuse_xacro(const tinyxml2::XMLElement& robot, std::string expected);

// The joints from link `base` to link `tip`, base first. Refuses links that are not there or not
// below one another, a link with two parents, a joint that is neither revolute, continuous,
// prismatic nor fixed, one with xacro in it, and a place or axis that is no three numbers, or such
// as only degrees or millimetres are.
[[nodiscard]] Read<std::vector<UrdfJoint>> urdf_path(const tinyxml2::XMLElement& robot,
                                                     const std::string& base,
                                                     const std::string& tip);

// What a joint that moves does at a reading.
[[nodiscard]] Pose moved_by(const UrdfJoint& joint, double reading);

// The joint of that name; nullptr where there is none.
[[nodiscard]] const tinyxml2::XMLElement* urdf_joint(const tinyxml2::XMLElement& robot,
                                                     std::string_view name);

// An attribute, empty where it is absent; and that of a child element: <parent link="base"/>.
[[nodiscard]] std::string attribute(const tinyxml2::XMLElement& element, const char* name);
[[nodiscard]] std::string child_attribute(const tinyxml2::XMLElement& element, const char* child,
                                          const char* name);

// The number of an attribute, `absent` where it is not there.
[[nodiscard]] Read<double> number_attribute(const tinyxml2::XMLElement& element, const char* name,
                                            double absent);

// The problem at the line of an element.
[[nodiscard]] std::unexpected<Problem> problem_at(const tinyxml2::XMLElement& element,
                                                  std::string what, std::string expected);

// Refuses a name that files and messages can't hold; `whose` it is: "a joint".
[[nodiscard]] Read<void> check_urdf_name(const tinyxml2::XMLElement& element,
                                         std::string_view whose);

}  // namespace armsig::tool
