// SPDX-License-Identifier: MIT
// Which columns of a table of other software are which of ours: separators, lines before the
// header, names, units. Nothing is guessed, and what is left aside is listed.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/formats/foreign_header.hpp"
#include "firmware/formats/foreign_table.hpp"

namespace armsig::tool {

struct MappedColumn {
  std::string ours;    // "x_mm"; "name", "time" of a point
  std::string theirs;  // "X [mm]"; "@7": the seventh column; "#1": the same number in every row
  std::optional<std::size_t> place = std::nullopt;  // from 0; nothing for a constant
};

// What an option such as --columns says.
struct Wanted {
  std::string option;
  bool automatic = false;
  std::vector<MappedColumn> entries;
};

// "auto", or entries OURS=THEIRS separated by commas (THEIRS in quotes, where it has one), where
// THEIRS is a name in the header, @N for the N-th column, or #NUMBER for every row. "auto" among
// them maps the rest.
[[nodiscard]] Read<Wanted> wanted_of(std::string_view option, std::string_view mapping);

enum class TableKind : std::uint8_t {
  kMeasurements,  // readings and positions
  kJointLog,      // readings, perhaps names or times
  kPoints,        // positions, perhaps names or times
  kTaught,        // readings, each with the frame and the point that it teaches
};

struct TableNeed {
  TableKind kind = TableKind::kMeasurements;
  NamedJoints joints;
  Wanted wanted;
  StatedUnits units;  // of columns whose header has none
};

struct TableLayout {
  std::size_t header_line = 0;  // of the file; 0 where there is none
  std::size_t first_row = 0;    // among the table's lines; may be their number
  char separator = ',';
  std::size_t width = 0;  // in columns
  std::vector<MappedColumn> columns;
  std::vector<std::string> ignored;  // columns of the file that nothing is made of

  [[nodiscard]] const MappedColumn* find(std::string_view quantity) const;
};

// Software writes its own name, dates and settings before the table; more than this is no header.
inline constexpr std::size_t kLongestPreamble = 60;

// The header is the first of kLongestPreamble lines that names what is needed, with semicolons,
// tabs, commas or blanks between its columns; a line of units may follow it, and it may stand in a
// comment. Refuses a table without one (but where `wanted` has only places), a column that could be
// another as well, a unit that contradicts `wanted`, and a joint outside the arm; each with what to
// do about it.
[[nodiscard]] Read<TableLayout> layout_of(const ForeignTable& table, const TableNeed& need);

// The cells of line `k` of the table. Refuses a row that is wider than the header, one that ends
// before a column that is mapped, and quotes that are not closed.
[[nodiscard]] Read<std::vector<std::string>> row_cells(const ForeignTable& table,
                                                       const TableLayout& layout, std::size_t k);

// Names of places and of what is unused, for people: "not used: RMS, column 7".
[[nodiscard]] std::string words_of_unused(const TableLayout& layout);

}  // namespace armsig::tool
