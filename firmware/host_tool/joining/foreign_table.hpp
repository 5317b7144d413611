// SPDX-License-Identifier: MIT
// The rows of a text file of other software, whatever separates its columns.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "firmware/formats/problem.hpp"

namespace armsig::tool {

struct ForeignRow {
  std::size_t line = 0;  // of the file, from 1
  std::vector<std::string> fields;
};

struct ForeignTable {
  std::string file;
  bool decimal_comma = false;
  std::vector<ForeignRow> rows;  // comments and blank lines left out; a header is the first of them
};

// Reads UTF-8 or UTF-16, at most 16 MiB and a million rows. Columns are separated by semicolons,
// tabs, commas, or blanks: the first of these that the file uses outside of quotes; lines that
// begin with //, # or ! are comments; empty columns at the end of a line are dropped. Where columns
// are not separated by commas, a comma between digits is a decimal one.
[[nodiscard]] Read<ForeignTable> read_foreign_table(const std::string& path);

// The number that `field` spells, with a decimal comma where the table has them; or nothing.
[[nodiscard]] std::optional<double> number_in(const ForeignTable& table, const std::string& field);

}  // namespace armsig::tool
