// SPDX-License-Identifier: MIT
// Measurements as other software exports them, as a text of ours.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/formats/foreign_mapping.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

struct MappedTable {
  std::string text;            // in our format, its lines those of the file
  std::size_t first_line = 1;  // the number of the first of them: 0 where the file has no header
  TableLayout layout;
  bool decimal_comma = false;
};

// `mapping` of --columns: as wanted_of() has it. What a table mapped by `auto` lacks is a constant:
// sweep 0, target 1. Refuses what layout_of() and row_cells() refuse, and numbers that could have a
// thousands separator.
[[nodiscard]] Read<MappedTable> map_measurements(const std::string& path, std::string_view mapping,
                                                 const NamedJoints& joints,
                                                 const StatedUnits& units = {});

// The same of taught points: `frame`, `point` and the readings, of which a table lacks none.
[[nodiscard]] Read<MappedTable> map_taught_points(const std::string& path, std::string_view mapping,
                                                  const NamedJoints& joints);

// What was made of what, a line each.
[[nodiscard]] std::string in_words(const MappedTable& mapped);

}  // namespace armsig::tool
