// SPDX-License-Identifier: MIT
// What the columns of a joint log or of a tracker's points are.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "firmware/formats/measurements.hpp"
#include "firmware/formats/units.hpp"
#include "firmware/host_tool/joining/foreign_table.hpp"

namespace armsig::tool {

// The units that a person states once, for columns whose header does not: "deg", "mm".
struct StatedUnits {
  std::string angle;   // deg, rad or empty
  std::string length;  // mm, m or empty
};

// "deg,mm" or "mm". Refuses any other word, and two of one kind.
[[nodiscard]] Read<StatedUnits> stated_units(std::string_view words);

// Rows that a measuring program may put above its header.
inline constexpr std::size_t kMostTitleRows = 60;

struct NumberColumn {
  std::size_t index = 0;
  Unit unit;
};

struct Columns {
  std::size_t first_row = 0;  // of the data, among the table's; above it titles and the header
  std::optional<std::size_t> name;  // of the point
  std::optional<std::size_t> time;
  std::optional<std::size_t> target;                    // its number
  FixedVector<NumberColumn, kMaxJoints> joints;         // all, or none
  std::optional<std::array<NumberColumn, 3>> position;  // x, y, z
  // The first two columns, by their places, that are of one reading or coordinate.
  std::optional<std::pair<std::size_t, std::size_t>> doubled = std::nullopt;
};

// By the header, its units or those stated: the first of the first kMostTitleRows rows that names
// the readings or a position. A table without one whose first row has a number has no header: its
// position is the last three columns that are numbers in every row, where these are three and no
// more after the first column with a word in it; the column before is the name. Refuses what
// leaves a choice, naming the cure.
[[nodiscard]] Read<Columns> columns_of(const ForeignTable& table, const JointTypes& types,
                                       const StatedUnits& units);

// The number in `column` of `row`, in SI.
[[nodiscard]] Read<double> number_of(const ForeignTable& table, const ForeignRow& row,
                                     const NumberColumn& column);

}  // namespace armsig::tool
