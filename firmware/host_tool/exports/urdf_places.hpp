// SPDX-License-Identifier: MIT
// Where the joints and their origins stand in the bytes of a URDF file, so that an origin can be
// changed and nothing else.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/pose.hpp"

namespace armsig::tool {

// Bytes [begin, end) of the text.
struct Bytes {
  std::size_t begin = 0;
  std::size_t end = 0;
};

struct JointPlace {
  Bytes tag;                    // <joint ...>
  std::optional<Bytes> origin;  // <origin ...> or <origin .../>, its first one
};

// The joints of the robot in the order of the file; comments, CDATA and joints inside of other
// elements (<transmission>) are none. Precondition: the text is well-formed XML.
[[nodiscard]] std::vector<JointPlace> joint_places(std::string_view text);

// End of the start tag of the root element; the text's end where there is none.
[[nodiscard]] std::size_t end_of_root_tag(std::string_view text);

// The text of an origin, <origin xyz="..." rpy="..."/>, with as many digits as read back the same.
[[nodiscard]] std::string origin_element(const Pose& X);

// The element `tag` (<origin ...> as the file has it) with X for its xyz and rpy; whatever else it
// says, and how it is laid out, stays.
[[nodiscard]] std::string with_origin(std::string_view tag, const Pose& X);

}  // namespace armsig::tool
