// SPDX-License-Identifier: MIT
// Pieces of the CSV files that armsig writes.
#pragma once

#include <string>
#include <string_view>

#include "core/base/arm.hpp"

namespace armsig::tool {

// "q1_deg,q2_mm,..." for the joints.
[[nodiscard]] std::string joint_header(const JointTypes& types);

// Every line of `comment` behind "# ", what is not printable escaped: for readers that end a line
// where we do not, it remains one comment.
[[nodiscard]] std::string comment_text(std::string_view comment);

}  // namespace armsig::tool
