// SPDX-License-Identifier: MIT
#include "firmware/host_tool/joining/columns.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/foreign_header.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

constexpr std::array<std::string_view, 9> kNameWords{
    "name", "point", "pointname", "id", "pose", "punkt", "pointid", "label", "measurement"};
constexpr std::array<std::string_view, 4> kTimeWords{"time", "timestamp", "datetime", "zeit"};

std::string letters_of(std::string_view header) {
  std::string letters;
  for (const char c : header) {
    if (c >= 'A' && c <= 'Z') letters += static_cast<char>(c - 'A' + 'a');
    if (c >= 'a' && c <= 'z') letters += c;
  }
  return letters;
}

template <std::size_t kCount>
bool is_one_of(std::string_view word, const std::array<std::string_view, kCount>& words) {
  return std::ranges::find(words, word) != words.end();
}

// The unit of this suffix among those of a dimension.
std::optional<Unit> unit_called(std::string_view suffix, Dimension dimension) {
  for (const Unit& unit : units_of(dimension)) {
    if (unit.suffix == suffix) return unit;
  }
  return std::nullopt;
}

// Our name for a column, its unit stated in the header or once for all.
std::optional<std::string> name_with(const std::string& header, const JointTypes& types,
                                     const StatedUnits& units) {
  if (auto ours = our_name_of(header, types)) return ours;
  for (const std::string& unit : {units.angle, units.length}) {
    if (unit.empty()) continue;
    if (auto ours = our_name_of(fmt::format("{} {}", header, unit), types)) return ours;
  }
  return std::nullopt;
}

NumberColumn number_column(std::size_t index, std::string_view ours, Dimension dimension) {
  const std::string_view suffix = ours.substr(ours.find('_') + 1);
  return {index, *unit_called(suffix, dimension)};
}

Columns from_header(const std::vector<std::string>& header, std::size_t first_row,
                    const JointTypes& types, const StatedUnits& units) {
  Columns columns{
      .first_row = first_row, .name = {}, .time = {}, .target = {}, .joints = {}, .position = {}};
  std::array<std::optional<NumberColumn>, kMaxJoints> joints;
  std::array<std::optional<NumberColumn>, 3> position;
  const auto take = [&](std::optional<NumberColumn>& place, const NumberColumn& column) {
    if (place && !columns.doubled) columns.doubled.emplace(place->index, column.index);
    place = column;
  };
  for (std::size_t k = 0; k < header.size(); ++k) {
    const std::string letters = letters_of(header[k]);
    if (is_one_of(letters, kTimeWords)) columns.time = k;
    if (is_one_of(letters, kNameWords) && !columns.name) columns.name = k;
    const auto ours = name_with(header[k], types, units);
    if (!ours) continue;
    if (*ours == "target" && letters == "target") columns.target = k;
    if (ours->front() == 'q') {
      const auto joint = static_cast<std::size_t>((*ours)[1] - '1');
      take(joints[joint], number_column(k, *ours, dimension_of(types[joint])));
    }
    const std::size_t axis = std::string_view("xyz").find(ours->front());
    if (axis != std::string_view::npos && (*ours)[1] == '_') {
      take(position[axis], number_column(k, *ours, Dimension::kLength));
    }
  }
  if (position[0] && position[1] && position[2])
    columns.position = {*position[0], *position[1], *position[2]};
  for (std::size_t j = 0; j < types.size() && joints[j]; ++j) columns.joints.push_back(*joints[j]);
  if (columns.joints.size() != types.size()) columns.joints.clear();
  return columns;
}

std::unexpected<Problem> in_table(const ForeignTable& table, std::string what,
                                  std::string expected) {
  return std::unexpected(Problem{table.file, static_cast<int>(table.rows.front().line), 0,
                                 std::move(what), std::move(expected)});
}

// Commanded and actual readings, say: which is meant nobody can guess.
std::unexpected<Problem> two_columns(const ForeignTable& table, const ForeignRow& header,
                                     const std::pair<std::size_t, std::size_t>& doubled) {
  return std::unexpected(Problem{
      table.file, static_cast<int>(header.line), 0,
      fmt::format("columns {} and {} are of one quantity", in_quotes(header.fields[doubled.first]),
                  in_quotes(header.fields[doubled.second])),
      "one of the two, the other left out or under another name"});
}

Read<Columns> without_header(const ForeignTable& table, const StatedUnits& units) {
  const std::size_t width = table.rows.front().fields.size();
  std::vector<bool> numeric(width, true);
  for (const ForeignRow& row : table.rows) {
    if (row.fields.size() != width) {
      return std::unexpected(Problem{table.file, static_cast<int>(row.line), 0,
                                     fmt::format("{} columns, {} before", row.fields.size(), width),
                                     "as many in every row, or a header"});
    }
    for (std::size_t k = 0; k < width; ++k) {
      numeric[k] = numeric[k] && number_in(table, row.fields[k]).has_value();
    }
  }
  std::size_t first = width;
  while (first > 0 && numeric[first - 1]) --first;
  const std::size_t count = width - first;
  // The name of a point may be a number too, where nothing stands before it.
  const bool named_by_number = first == 0 && count == 4;
  const bool named_by_number_in_group = first == 2 && count == 4;
  if (count != 3 && !named_by_number && !named_by_number_in_group) {
    return in_table(table, fmt::format("{} columns of numbers and no header", count),
                    "a line above them that says which are what, such as Name X Y Z");
  }
  if (units.length.empty()) {
    return in_table(table, "no header, so nothing says the unit of x, y, z", "--units mm, or m");
  }
  const Unit unit = *unit_called(units.length, Dimension::kLength);
  const std::size_t x = width - 3;
  Columns columns;
  columns.position = {NumberColumn{x, unit}, NumberColumn{x + 1, unit}, NumberColumn{x + 2, unit}};
  if (x > 0) columns.name = x - 1;
  return columns;
}

}  // namespace

Read<StatedUnits> stated_units(std::string_view words) {
  StatedUnits units;
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(','), words.size());
    const std::string word(trimmed(words.substr(0, end)));
    words.remove_prefix(std::min(end + 1, words.size()));
    const bool angle = unit_called(word, Dimension::kAngle).has_value();
    const bool length = unit_called(word, Dimension::kLength).has_value();
    std::string& unit = angle ? units.angle : units.length;
    if ((!angle && !length) || !unit.empty()) {
      return std::unexpected(Problem{"--units", 0, 0, in_quotes(word),
                                     "deg or rad, mm or m, each once: --units deg,mm"});
    }
    unit = word;
  }
  return units;
}

Read<Columns> columns_of(const ForeignTable& table, const JointTypes& types,
                         const StatedUnits& units) {
  const std::size_t last = std::min(table.rows.size(), kMostTitleRows);
  for (std::size_t row = 0; row < last; ++row) {
    const Columns columns = from_header(table.rows[row].fields, row + 1, types, units);
    if (columns.joints.empty() && !columns.position) continue;
    if (columns.doubled) return two_columns(table, table.rows[row], *columns.doubled);
    return columns;
  }
  const bool has_number = std::ranges::any_of(
      table.rows.front().fields,
      [&](const std::string& field) { return number_in(table, field).has_value(); });
  return has_number ? without_header(table, units)
                    : from_header(table.rows.front().fields, 1, types, units);
}

Read<double> number_of(const ForeignTable& table, const ForeignRow& row,
                       const NumberColumn& column) {
  const auto wrong = [&](const std::string& what) {
    return std::unexpected(Problem{table.file, static_cast<int>(row.line),
                                   static_cast<int>(column.index + 1), what, "a number"});
  };
  if (column.index >= row.fields.size()) return wrong("the row ends before this column");
  const auto number = number_in(table, row.fields[column.index]);
  if (!number) return wrong(in_quotes(row.fields[column.index]));
  return column.unit.to_si(*number);
}

}  // namespace armsig::tool
