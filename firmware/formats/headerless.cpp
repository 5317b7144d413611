// SPDX-License-Identifier: MIT
#include "firmware/formats/headerless.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/table_cells.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/timestamp.hpp"

namespace armsig::tool {
namespace {

// What every row of a column has in common.
struct ColumnContent {
  bool numbers = true;
  bool times = true;
  bool dates = true;  // of a date column beside one of times
};

bool is_time(std::string_view text) {
  const auto time = parse_time(text, DateOrder::kUnknown);
  return time || time.error() == TimeFault::kAmbiguousDate;
}

// The content of each column; nothing where the rows are not equally wide.
Read<std::optional<std::vector<ColumnContent>>> contents(const ForeignTable& table,
                                                         char separator) {
  std::vector<ColumnContent> columns;
  for (std::size_t k = table.row_from(0); k < table.size(); k = table.row_from(k + 1)) {
    const auto cells = split_line(table.line(k).text, separator);
    if (!cells) return std::nullopt;
    if (columns.empty()) columns.resize(cells->size());
    if (cells->size() != columns.size()) {
      return table.at(k, fmt::format("{} columns, {} before", cells->size(), columns.size()),
                      "as many in every row, or a header");
    }
    for (std::size_t c = 0; c < cells->size(); ++c) {
      const std::string& cell = (*cells)[c];
      columns[c].numbers = columns[c].numbers && is_number(cell, separator);
      columns[c].times = columns[c].times && is_time(cell);
      columns[c].dates = columns[c].dates && is_time(cell + " 00:00:00");
    }
  }
  return columns;
}

// Three commas, and behind them a unit: "... X,  Y,  Z (mm)".
std::string unit_in_comments(const ForeignTable& table) {
  for (std::size_t k = 0; k < table.size(); ++k) {
    if (!table.line(k).is_comment) continue;
    const auto cells = split_line(table.line(k).text, ',');
    if (!cells || cells->size() < 3) continue;
    const std::string& z = cells->back();
    const auto last_of = [](const std::string& cell) {
      return cell.substr(std::min(cell.find_last_of(" :") + 1, cell.size()));
    };
    const bool axes = last_of((*cells)[cells->size() - 3]) == "X" &&
                      (*cells)[cells->size() - 2] == "Y" && z.starts_with("Z");
    if (!axes) continue;
    const auto meaning = meaning_of(z, {});
    if (meaning && meaning->has_good_unit()) return meaning->unit;
  }
  return {};
}

// Where x stands; nothing where the numbers leave a choice.
std::optional<std::size_t> place_of_x(const std::vector<ColumnContent>& columns, std::size_t first,
                                      std::size_t count) {
  constexpr std::size_t kCoordinates = 3;
  const bool rest_is_text =
      std::none_of(columns.begin() + static_cast<std::ptrdiff_t>(first + count), columns.end(),
                   [](const ColumnContent& column) { return column.numbers; });
  if (!rest_is_text) return std::nullopt;
  if (count == kCoordinates) return first;
  // The name of a point may be a number too, where nothing or its group stands before it.
  if (count == kCoordinates + 1 && (first == 0 || first == 2)) return first + 1;
  return std::nullopt;
}

// Names before x, a time behind z; false where there are others.
bool add_texts(TableLayout& layout, std::size_t x, const std::vector<ColumnContent>& columns) {
  const auto add = [&](const char* ours, std::size_t place) {
    layout.columns.push_back({ours, fmt::format("@{}", place + 1), place});
  };
  constexpr std::array kParts{"name", "group", "collection"};
  if (x > kParts.size()) return false;
  for (std::size_t k = 0; k < x; ++k) add(kParts[k], x - 1 - k);
  const std::size_t after = x + 3;
  const std::size_t rest = columns.size() - after;
  if (rest == 1 && columns[after].times) {
    add("time", after);
  } else if (rest == 2 && columns[after].dates && columns[after + 1].times) {
    add("date", after);
    add("time", after + 1);
  } else if (rest > 0) {
    return false;
  }
  return true;
}

// The last run of columns of numbers.
struct Run {
  std::size_t first = 0;
  std::size_t count = 0;
};
Run last_numbers(const std::vector<ColumnContent>& columns) {
  std::size_t end = columns.size();
  while (end > 0 && !columns[end - 1].numbers) --end;
  std::size_t begin = end;
  while (begin > 0 && columns[begin - 1].numbers) --begin;
  return {begin, end - begin};
}

// x, y and z from column `x` on, in the unit that the person or a comment states.
Read<void> add_coordinates(const ForeignTable& table, const StatedUnits& units, std::size_t x,
                           TableLayout& layout) {
  const std::string stated = unit_in_comments(table);
  const std::string unit = units.length.empty() ? stated : units.length;
  if (unit.empty()) {
    return table.at(layout.first_row, "no header, so nothing says the unit of x, y, z",
                    "--units mm, or m");
  }
  if (!stated.empty() && stated != unit) {
    return table.problem(fmt::format("a comment says {}, --units {}", stated, unit),
                         "one of the two");
  }
  for (std::size_t k = 0; k < 3; ++k) {
    layout.columns.push_back(
        {fmt::format("{}_{}", "xyz"[k], unit), fmt::format("@{}", x + k + 1), x + k});
  }
  return {};
}

std::unexpected<Problem> no_choice(const ForeignTable& table, std::size_t first,
                                   std::size_t count) {
  return table.at(first, fmt::format("{} columns of numbers and no header", count),
                  "a line above them that says which are what, such as Name X Y Z; or "
                  "--point-columns x_mm=@2,y_mm=@3,z_mm=@4");
}

}  // namespace

bool is_number(std::string_view cell, char separator) {
  std::string spelt(cell);
  if (separator != ',' && std::ranges::count(spelt, ',') == 1 && !spelt.contains('.')) {
    std::ranges::replace(spelt, ',', '.');
  }
  return parse_number(spelt).has_value();
}

bool is_text_column(std::string_view ours) {
  const std::string_view quantity = quantity_of(ours);
  constexpr std::array<std::string_view, 7> kTexts{"name", "group", "collection", "time",
                                                   "date", "frame", "point"};
  return std::ranges::find(kTexts, quantity) != kTexts.end();
}

Read<std::optional<TableLayout>> headerless_points(const ForeignTable& table,
                                                   const StatedUnits& units) {
  const std::size_t first_row = table.row_from(0);
  std::optional<Problem> problem;
  for (const char separator : {';', '\t', ',', kBlanks}) {
    const auto first = split_line(table.line(first_row).text, separator);
    const auto is_a_number = [&](const std::string& cell) { return is_number(cell, separator); };
    if (!first || first->size() < 3 || std::ranges::none_of(*first, is_a_number)) continue;
    auto columns = contents(table, separator);
    if (!columns) {
      if (!problem) problem = std::move(columns).error();
      continue;
    }
    if (!*columns) continue;
    const Run run = last_numbers(**columns);
    TableLayout layout;
    layout.first_row = first_row;
    layout.separator = separator;
    layout.width = (*columns)->size();
    const auto x = place_of_x(**columns, run.first, run.count);
    if (!x || !add_texts(layout, *x, **columns)) {
      if (!problem) problem = no_choice(table, first_row, run.count).error();
      continue;
    }
    if (auto added = add_coordinates(table, units, *x, layout); !added) {
      return std::unexpected(std::move(added).error());
    }
    return layout;
  }
  if (problem) return std::unexpected(*std::move(problem));
  return std::nullopt;
}

}  // namespace armsig::tool
