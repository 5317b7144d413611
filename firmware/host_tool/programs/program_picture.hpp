// SPDX-License-Identifier: MIT
// A program before and after, for the eye: where its targets are, by how much the tool misses each
// of them, and in which direction.
#pragma once

#include <string>
#include <string_view>

#include "firmware/host_tool/programs/correct_program.hpp"

namespace armsig::tool {

struct RunProgram {
  const Arrivals& before;
  const Arrivals* after = nullptr;  // of the corrected program; null where there is none
};

// An SVG that stands alone, light and dark. From above (x, y), from the side (x, z) in the
// controller's base, misses magnified by a round number that the picture states; below a bar for
// each target. `title` is any text. Precondition: `before` is not empty.
[[nodiscard]] std::string program_picture(const RunProgram& run, std::string_view title);

}  // namespace armsig::tool
