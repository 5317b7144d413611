// SPDX-License-Identifier: MIT
// Measurements as other software exports them: semicolons or tabs, decimal commas, lines before the
// header, units in brackets, names of its own.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/formats/measurements.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

struct MappedColumn {
  std::string ours;    // "x_mm"
  std::string theirs;  // "X [mm]", or "#1": the same number in every row
};

struct MappedMeasurements {
  std::string text;  // in our format, its lines those of the file
  std::vector<MappedColumn> columns;
  std::vector<std::string> ignored;  // columns of the file that nothing is made of
  char separator = ',';
  bool decimal_comma = false;
  std::size_t header_line = 0;
};

// `mapping`: "auto", or entries OURS=THEIRS separated by commas, where THEIRS is a name in the
// header or #NUMBER for every row; "auto" among them maps the rest. Automatic mapping goes by name
// and stated unit ("X [mm]", "y (m)", "A1 [°]", "Joint 2 deg", "Sweep", "Point"); it never guesses
// a unit. A line is taken for the header when it has every name asked for.
[[nodiscard]] Read<MappedMeasurements> map_measurements(const std::string& path,
                                                        std::string_view mapping,
                                                        const JointTypes& types);

// What was made of what, a line each.
[[nodiscard]] std::string in_words(const MappedMeasurements& mapped);

}  // namespace armsig::tool
