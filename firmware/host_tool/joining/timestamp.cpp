// SPDX-License-Identifier: MIT
#include "firmware/host_tool/joining/timestamp.hpp"

#include <chrono>

#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

std::optional<int> integer_at(std::string_view text, std::size_t from, std::size_t length) {
  if (text.size() < from + length) return std::nullopt;
  return parse_integer(text.substr(from, length));
}

// HH:MM:SS.sss, perhaps with Z, +02:00 or a word behind it.
std::optional<double> seconds_of_day(std::string_view text) {
  const auto hour = integer_at(text, 0, 2);
  const auto minute = integer_at(text, 3, 2);
  if (!hour || !minute || text[2] != ':' || text.size() < 8 || text[5] != ':') return std::nullopt;
  std::size_t end = 6;
  while (end < text.size() && ((text[end] >= '0' && text[end] <= '9') || text[end] == '.')) ++end;
  const auto second = parse_number(text.substr(6, end - 6));
  if (!second || *hour > 23 || *minute > 59 || *second >= 61) return std::nullopt;
  return 3600.0 * *hour + 60.0 * *minute + *second;
}

}  // namespace

std::optional<double> seconds_of(std::string_view text) {
  text = trimmed(text);
  if (const auto number = parse_number(text)) return number;
  constexpr std::size_t kDate = 10;
  const bool by_year = text.size() > kDate && text[4] == '-' && text[7] == '-';
  const bool by_day = text.size() > kDate && text[2] == '.' && text[5] == '.';
  if (!by_year && !by_day) return seconds_of_day(text);
  const auto year = integer_at(text, by_year ? 0 : 6, 4);
  const auto month = integer_at(text, by_year ? 5 : 3, 2);
  const auto day = integer_at(text, by_year ? 8 : 0, 2);
  const auto of_day = seconds_of_day(text.substr(kDate + 1));
  if (!year || !month || !day || !of_day) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year{*year},
                                         std::chrono::month{static_cast<unsigned>(*month)},
                                         std::chrono::day{static_cast<unsigned>(*day)}};
  if (!date.ok()) return std::nullopt;
  const std::chrono::seconds whole = std::chrono::sys_days{date}.time_since_epoch();
  return static_cast<double>(whole.count()) + *of_day;
}

}  // namespace armsig::tool
