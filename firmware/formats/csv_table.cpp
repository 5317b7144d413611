// SPDX-License-Identifier: MIT
#include "firmware/formats/csv_table.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/base/check.hpp"
#include "core/base/error.hpp"
#include "firmware/formats/infinity.hpp"
#include "firmware/formats/pi_text.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

constexpr double kEmpty = std::numeric_limits<double>::quiet_NaN();

char separator_of(std::string_view header) {
  for (const char separator : {';', '\t', ','}) {
    if (header.find(separator) != std::string_view::npos) return separator;
  }
  return kBlanks;
}

std::vector<std::string> all_names(const std::vector<Quantity>& quantities) {
  std::vector<std::string> names;
  for (const Quantity& quantity : quantities) {
    for (std::string& name : names_of(quantity.name, quantity.dimension)) {
      names.push_back(std::move(name));
    }
  }
  return names;
}

// Is `name` spelt like a joint reading: q, digits, then nothing or a unit?
bool looks_like_a_joint(std::string_view name) {
  if (!name.starts_with('q')) return false;
  const std::size_t digits_end = std::min(name.find('_'), name.size());
  const std::string_view digits = name.substr(1, digits_end - 1);
  return !digits.empty() &&
         std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::vector<Quantity> joint_quantities(const JointTypes& types) {
  std::vector<Quantity> quantities;
  quantities.reserve(types.size());
  for (std::size_t i = 0; i < types.size(); ++i) {
    quantities.push_back({fmt::format("q{}", i + 1), dimension_of(types[i]), true, false,
                          fmt::format("joint {} is {}", i + 1, word_of(types[i]))});
  }
  return quantities;
}

CsvTable::CsvTable(LineReader lines, std::vector<Quantity> quantities, Style style)
    : lines_(std::move(lines)), style_(style), quantities_(std::move(quantities)) {
  values_.assign(quantities_.size(), kEmpty);
}

Read<CsvTable> CsvTable::open(LineReader lines, std::vector<Quantity> quantities, Style style) {
  CsvTable table(std::move(lines), std::move(quantities), style);
  if (auto header = table.read_header(); !header) {
    return std::unexpected(std::move(header).error());
  }
  return table;
}

bool CsvTable::has(std::size_t quantity) const {
  return std::ranges::find(columns_, quantity, &Column::quantity) != columns_.end();
}

const CsvTable::Column& CsvTable::column_of(std::size_t quantity) const {
  const auto column = std::ranges::find(columns_, quantity, &Column::quantity);
  ARMSIG_CHECK(column != columns_.end());
  return *column;
}

const Unit& CsvTable::unit(std::size_t quantity) const { return column_of(quantity).unit; }

const std::string& CsvTable::header(std::size_t quantity) const { return column_of(quantity).name; }

std::unexpected<Problem> CsvTable::at(std::size_t position, std::string what,
                                      std::string expected) const {
  return std::unexpected(Problem{lines_.file(), static_cast<int>(lines_.number()),
                                 static_cast<int>(position + 1), std::move(what),
                                 std::move(expected)});
}

std::unexpected<Problem> CsvTable::problem(std::string what, std::string expected) const {
  return std::unexpected(Problem{lines_.file(), static_cast<int>(lines_.number()), 0,
                                 std::move(what), std::move(expected)});
}

std::unexpected<Problem> CsvTable::problem(std::size_t quantity, std::string what,
                                           std::string expected) const {
  Cells fields = cells();
  for (const Column& column : columns_) {
    if (!fields.next()) break;
    if (column.quantity == quantity) {
      return at(fields.position(), std::move(what), std::move(expected));
    }
  }
  return problem(std::move(what), std::move(expected));
}

std::string_view CsvTable::field(std::size_t quantity) const {
  Cells fields = cells();
  for (const Column& column : columns_) {
    if (!fields.next()) break;
    if (column.quantity == quantity) return fields.text();
  }
  return {};
}

std::unexpected<Problem> CsvTable::unknown_column(std::string_view name,
                                                  std::size_t position) const {
  if (name.empty()) return at(position, "a column without a name", "a name between the commas");
  for (const Quantity& quantity : quantities_) {
    const bool has_unit = !units_of(quantity.dimension).empty();
    const std::string expected = any_of(names_of(quantity.name, quantity.dimension));
    if (has_unit && name == quantity.name) {
      return at(position, fmt::format("column {} has no unit", in_quotes(name)), expected);
    }
    if (has_unit && name.starts_with(quantity.name + "_")) {
      const std::string note = quantity.note.empty() ? "" : ", and " + quantity.note;
      return at(position, fmt::format("column {} has another unit{}", in_quotes(name), note),
                expected);
    }
  }
  // Of joints that have units: the quaternion of ABB has not.
  const auto joints = std::ranges::count_if(quantities_, [](const Quantity& quantity) {
    return looks_like_a_joint(quantity.name) && !units_of(quantity.dimension).empty();
  });
  if (joints > 0 && looks_like_a_joint(name)) {
    return at(position,
              fmt::format("column {} is for a joint outside the arm, which has {}", in_quotes(name),
                          joints),
              fmt::format("q1 to q{}", joints));
  }
  const std::vector<std::string> names = all_names(quantities_);
  const std::string meant = nearest(name, names);
  return at(position, fmt::format("unknown column {}", in_quotes(name)),
            meant.empty() ? "names separated by commas, out of " + any_of(names) : meant);
}

Read<CsvTable::Column> CsvTable::column_named(std::string_view name, std::size_t position) const {
  for (std::size_t i = 0; i < quantities_.size(); ++i) {
    const Quantity& quantity = quantities_[i];
    if (!name.starts_with(quantity.name)) continue;
    const std::span<const Unit> units = units_of(quantity.dimension);
    if (units.empty() && name == quantity.name) {
      return Column{i, quantity.dimension, {}, std::string(name)};
    }
    for (const Unit& unit : units) {
      if (name == fmt::format("{}_{}", quantity.name, unit.suffix)) {
        return Column{i, quantity.dimension, unit, std::string(name)};
      }
    }
  }
  return unknown_column(name, position);
}

Read<void> CsvTable::read_header() {
  ARMSIG_TRY(more, lines_.next());
  if (!more) {
    return std::unexpected(Problem{lines_.file(), 0, 0, std::string(lines_.what_it_is()),
                                   "a header line, then one row a line"});
  }
  if (style_ == Style::kForeign) {
    separator_ = separator_of(lines_.line());
    numbers_ = TableNumbers(separator_);
  }
  for (Cells fields = cells(); fields.next();) {
    ARMSIG_TRY(column, column_named(fields.text(), fields.position()));
    const auto earlier = std::ranges::find(columns_, column.quantity, &Column::quantity);
    if (earlier != columns_.end()) {
      return at(
          fields.position(),
          fmt::format("column {} gives {} a second time (first as {})", in_quotes(column.name),
                      quantities_[column.quantity].name, in_quotes(earlier->name)),
          "each column once");
    }
    columns_.push_back(std::move(column));
  }
  for (std::size_t i = 0; i < quantities_.size(); ++i) {
    if (!quantities_[i].required || has(i)) continue;
    return problem(fmt::format("there is no column for {}", quantities_[i].name),
                   any_of(names_of(quantities_[i].name, quantities_[i].dimension)));
  }
  return {};
}

Read<void> CsvTable::parse_field(std::string_view text, const Column& column,
                                 std::size_t position) {
  double& value = values_[column.quantity];
  if (column.dimension == Dimension::kText) return {};
  if (text.empty()) {
    if (!quantities_[column.quantity].may_be_empty) {
      return at(position, fmt::format("{} is empty", column.name), "a number");
    }
    value = kEmpty;
    return {};
  }
  if (column.dimension == Dimension::kInteger) {
    const auto integer = parse_integer(text);
    if (!integer) {
      return at(position, fmt::format("{}: {} is not an integer", column.name, in_quotes(text)),
                "an integer");
    }
    value = *integer;
    return {};
  }
  ARMSIG_TRY(number, parse_value(text, column, position));
  value = column.unit.to_si(number);
  return {};
}

Read<double> CsvTable::parse_value(std::string_view text, const Column& column,
                                   std::size_t position) {
  if (style_ == Style::kForeign && column.dimension == Dimension::kAngle && names_pi(text)) {
    const auto angle = parse_pi(text);
    if (angle && column.unit.to_si(1) == 1) return *angle;
    return at(position, fmt::format("{}: {}", column.name, in_quotes(text)),
              angle ? "degrees, or a column in _rad" : "a number, or such as pi/2 and -3*pi/4");
  }
  if (style_ == Style::kForeign && column.dimension == Dimension::kNone) {
    if (const auto infinity = parse_infinity(text)) return *infinity;
  }
  std::string plain(text);
  if (style_ == Style::kForeign) {
    auto decimal = numbers_.plain(text, column.name, lines_.number());
    if (!decimal) {
      return at(position, std::move(decimal.error().what), std::move(decimal.error().expected));
    }
    plain = *decimal;
  }
  const auto number = parse_number(plain);
  if (number) return *number;
  return at(position, fmt::format("{}: {}", column.name, why_not_a_number(text)), "a number");
}

Read<bool> CsvTable::next() {
  ARMSIG_TRY(more, lines_.next());
  if (!more) {
    if (!numbers_.decimal_comma()) return false;
    if (auto whole = in_file(lines_.file(), numbers_.finish()); !whole) {
      return std::unexpected(std::move(whole).error());
    }
    return false;
  }
  Cells fields = cells();
  std::size_t count = 0;
  for (const Column& column : columns_) {
    if (!fields.next()) {
      return at(lines_.line().size(),
                fmt::format("the row ends after {} of {} fields", count, columns_.size()),
                fmt::format("{} next", column.name));
    }
    ++count;
    if (auto field = parse_field(fields.text(), column, fields.position()); !field) {
      return std::unexpected(std::move(field).error());
    }
  }
  if (fields.next()) {
    return at(
        fields.position(),
        fmt::format("{} follows the last of {} fields", in_quotes(fields.text()), columns_.size()),
        "the end of the row");
  }
  return true;
}

}  // namespace armsig::tool
