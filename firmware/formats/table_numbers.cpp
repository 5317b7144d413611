// SPDX-License-Identifier: MIT
#include "firmware/formats/table_numbers.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// "1,234", "-12.345": as a number with a separator of thousands would be, too.
bool is_grouped(std::string_view text, std::size_t sign) {
  std::string_view before = text.substr(0, sign);
  if (!before.empty() && (before.front() == '-' || before.front() == '+')) before.remove_prefix(1);
  const std::string_view after = text.substr(sign + 1);
  return !before.empty() && before.size() <= 3 && before.front() != '0' && after.size() == 3 &&
         std::ranges::all_of(before, is_digit) && std::ranges::all_of(after, is_digit);
}

}  // namespace

void TableNumbers::note(std::string_view text, std::string_view column, std::size_t line) {
  auto found = columns_.find(column);
  if (found == columns_.end()) found = columns_.emplace(std::string(column), Column{}).first;
  const std::size_t sign = text.find_first_of(".,");
  if (sign == std::string_view::npos) {
    found->second.has_integers = found->second.has_integers || parse_integer(text).has_value();
    return;
  }
  only_groups_ = only_groups_ && is_grouped(text, sign);
  if (found->second.line == 0) {
    found->second.first = text;
    found->second.line = line;
  }
}

Read<std::string> TableNumbers::plain(std::string_view text, std::string_view column,
                                      std::size_t line) {
  const auto refused = [&](const char* what, std::string expected) {
    return problem_at(static_cast<int>(line), 0,
                      fmt::format("{}: {} {}", column, in_quotes(text), what), std::move(expected));
  };
  const auto commas = std::ranges::count(text, ',');
  const bool point = text.find('.') != std::string_view::npos;
  if (commas > 1 || (commas == 1 && point)) {
    return refused("has more than a decimal separator", "a number without thousands separators");
  }
  if (commas == 1 && separator_ == ',') {
    return refused("may have a decimal comma or a thousands separator",
                   "decimal points where commas separate the columns; or columns separated by "
                   "semicolons or tabs");
  }
  if ((commas == 1 && point_) || (point && comma_)) {
    return refused("has another decimal separator than the lines before",
                   "points in all numbers, or commas in all");
  }
  comma_ = comma_ || commas == 1;
  point_ = point_ || point;
  note(text, column, line);
  std::string spelt(text);
  std::ranges::replace(spelt, ',', '.');
  return spelt;
}

Read<void> TableNumbers::finish() const {
  if (!only_groups_) return {};
  for (const auto& [name, column] : columns_) {
    if (column.line == 0 || !column.has_integers) continue;
    return problem_at(static_cast<int>(column.line), 0,
                      fmt::format("{}: {} may have a thousands separator: other numbers of the "
                                  "column have none",
                                  name, in_quotes(column.first)),
                      "numbers without thousands separators; decimals in all rows, or other than "
                      "three in some");
  }
  return {};
}

}  // namespace armsig::tool
