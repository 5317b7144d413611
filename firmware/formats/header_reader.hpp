// SPDX-License-Identifier: MIT
// One line of a table of other software as its header.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/formats/foreign_mapping.hpp"

namespace armsig::tool {

// A line that may be the header.
struct HeaderCandidate {
  TableLayout layout;
  std::vector<std::string> cells;  // with the unit of the line below
  std::size_t named = 0;           // of what is needed, with a unit or without
  bool complete = false;
  std::string doubt;             // a column whose unit is missing or another
  std::optional<Problem> fault;  // of a complete one
};

// Line `k`, its columns separated by `separator`; nothing where it can't be the header.
[[nodiscard]] std::optional<HeaderCandidate> read_header(const ForeignTable& table,
                                                         const TableNeed& need, std::size_t k,
                                                         char separator);

// What a mapping may name: "#1", "@7" and its place from 0.
[[nodiscard]] bool is_constant(std::string_view theirs);
[[nodiscard]] bool is_place(std::string_view theirs);
[[nodiscard]] std::optional<std::size_t> place_of(std::string_view theirs);

[[nodiscard]] bool is_mapped(const TableLayout& layout, std::size_t place);

// The quantities without which a table is of no use; `columns`: those that are mapped.
[[nodiscard]] std::vector<std::string> needed_quantities(const TableNeed& need,
                                                         const std::vector<MappedColumn>& columns);

}  // namespace armsig::tool
