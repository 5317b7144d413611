// SPDX-License-Identifier: MIT
// Tables of points without a header: text columns, then x, y, z, as SpatialAnalyzer writes them.
#pragma once

#include <optional>
#include <string_view>

#include "firmware/formats/foreign_mapping.hpp"

namespace armsig::tool {

// Whether a cell is a number, perhaps with a decimal comma where no comma separates columns.
[[nodiscard]] bool is_number(std::string_view cell, char separator);

// Whether a column of ours holds text: name, group, collection, time, date,
// frame, point.
[[nodiscard]] bool is_text_column(std::string_view ours);

// The three columns that are numbers in every row, or the last three of four where the first of
// them begins the row or follows two of text (points named by number); the text before them is the
// name in its group and collection, what follows them is a time. The unit is stated, or in a
// comment like SpatialAnalyzer's "AXES = CARTESIAN: X,  Y,  Z (mm)". Nothing where the first row
// has no number; refuses what leaves a choice.
[[nodiscard]] Read<std::optional<TableLayout>> headerless_points(const ForeignTable& table,
                                                                 const StatedUnits& units);

}  // namespace armsig::tool
