// SPDX-License-Identifier: MIT
#include "firmware/formats/timestamp.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <string>

#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

constexpr double kDay_s = 86400;

// Takes pieces off the front of a text; at the end nothing may be left.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : rest_(text) {}

  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  [[nodiscard]] std::string_view rest() const { return rest_; }

  bool take(char c) {
    if (!rest_.starts_with(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }
  bool take_word(std::string_view word) {  // in capitals or not
    const bool same = rest_.size() >= word.size() &&
                      std::ranges::equal(rest_.substr(0, word.size()), word, {}, upper, upper);
    if (same) rest_.remove_prefix(word.size());
    return same;
  }
  void skip_blanks() { rest_ = trimmed(rest_); }
  [[nodiscard]] std::size_t digits() const {
    return std::min(rest_.find_first_not_of("0123456789"), rest_.size());
  }
  // A number of `fewest` to `most` digits, and no more behind them.
  std::optional<int> number(std::size_t fewest, std::size_t most) {
    const std::size_t count = digits();
    if (count < fewest || count > most) return std::nullopt;
    const auto value = parse_integer(rest_.substr(0, count));
    rest_.remove_prefix(count);
    return value;
  }
  // The digits of a fraction, as a fraction.
  double fraction() {
    const std::size_t count = digits();
    const auto value = parse_number("0." + std::string(rest_.substr(0, count)));
    rest_.remove_prefix(count);
    return value.value_or(0);
  }

 private:
  static char upper(char c) {
    return static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  std::string_view rest_;
};

struct Date {
  int year = 0;
  int month = 0;
  int day = 0;
  bool is_either_way = false;  // day and month could be the other way round
};

// Two digits are a year from 1970 to 2069.
int full_year(int year, std::size_t digits) {
  if (digits > 2) return year;
  return year + (year < 70 ? 2000 : 1900);
}

std::optional<int> month_called(Scanner& scanner) {
  constexpr std::array<std::string_view, 12> kMonths{"JAN", "FEB", "MAR", "APR", "MAY", "JUN",
                                                     "JUL", "AUG", "SEP", "OCT", "NOV", "DEC"};
  for (std::size_t k = 0; k < kMonths.size(); ++k) {
    if (scanner.take_word(kMonths[k])) return static_cast<int>(k + 1);
  }
  return std::nullopt;
}

// After the first number and its sign, which is no year.
std::optional<Date> date_after(int first, char sign, DateOrder order, Scanner& scanner) {
  Date date{.year = 0, .month = 0, .day = first};
  const auto month = sign == '-' ? month_called(scanner) : std::nullopt;
  const auto second = month ? month : scanner.number(1, 2);
  if (!second || !scanner.take(sign)) return std::nullopt;
  const std::size_t digits = scanner.digits();
  const auto year = digits == 3 ? std::nullopt : scanner.number(2, 4);
  if (!year) return std::nullopt;
  date.year = full_year(*year, digits);
  date.month = *second;
  if (month || sign == '.') return date;
  constexpr int kMonths = 12;
  date.is_either_way = first <= kMonths && *second <= kMonths && first != *second;
  const bool month_first =
      *second > kMonths || (date.is_either_way && order == DateOrder::kMonthFirst);
  if (month_first) std::swap(date.day, date.month);
  return date;
}

std::optional<Date> take_date(DateOrder order, Scanner& scanner) {
  const std::size_t digits = scanner.digits();
  const auto first = scanner.number(1, 4);
  if (!first || digits == 3) return std::nullopt;
  for (const char sign : {'-', '/', '.'}) {
    if (!scanner.take(sign)) continue;
    if (digits < 3) return date_after(*first, sign, order, scanner);
    const auto month = scanner.number(1, 2);
    if (!month || !scanner.take(sign)) return std::nullopt;
    const auto day = scanner.number(1, 2);
    if (!day) return std::nullopt;
    return Date{.year = *first, .month = *month, .day = *day};
  }
  return std::nullopt;
}

// H:MM:SS, with a fraction, AM or PM; in seconds.
std::optional<double> take_clock(Scanner& scanner) {
  auto hour = scanner.number(1, 2);
  if (!hour || !scanner.take(':')) return std::nullopt;
  const auto minute = scanner.number(2, 2);
  if (!minute || !scanner.take(':')) return std::nullopt;
  const auto second = scanner.number(2, 2);
  if (!second) return std::nullopt;
  double fraction = 0;
  if (scanner.take('.') || scanner.take(',')) {
    if (scanner.digits() == 0) return std::nullopt;
    fraction = scanner.fraction();
  }
  scanner.skip_blanks();
  const bool am = scanner.take_word("AM") || scanner.take_word("A.M.");
  const bool pm = !am && (scanner.take_word("PM") || scanner.take_word("P.M."));
  constexpr int kNoon = 12;
  if (am || pm) {
    if (*hour < 1 || *hour > kNoon) return std::nullopt;
    hour = *hour % kNoon + (pm ? kNoon : 0);
  }
  if (*hour > 23 || *minute > 59 || *second > 60) return std::nullopt;
  // A leap second ends an hour, or half of one where the offset from UTC has a half.
  if (*second == 60 && *minute != 59 && *minute != 29) return std::nullopt;
  return 3600.0 * *hour + 60.0 * *minute + *second + fraction;
}

// The offset from UTC in seconds; nothing where there is none. `scanner` stays on what is no
// offset.
std::optional<double> take_zone(Scanner& scanner) {
  scanner.skip_blanks();
  if (scanner.take('Z') || scanner.take_word("UTC") || scanner.take_word("GMT")) return 0;
  Scanner ahead = scanner;
  const bool east = ahead.take('+');
  if (!east && !ahead.take('-')) return std::nullopt;
  const bool together = ahead.digits() == 4;
  std::optional<int> hours;
  std::optional<int> minutes = 0;
  if (together) {
    const auto both = ahead.number(4, 4);
    hours = *both / 100;
    minutes = *both % 100;
  } else {
    hours = ahead.number(1, 2);
    if (ahead.take(':')) minutes = ahead.number(2, 2);
  }
  constexpr int kFarthest = 14;  // hours: Kiribati
  if (!hours || !minutes || *hours > kFarthest || *minutes > 59) return std::nullopt;
  scanner = ahead;
  return (east ? 1 : -1) * (3600.0 * *hours + 60.0 * *minutes);
}

std::optional<double> seconds_of(const Date& date) {
  if (date.month < 1 || date.day < 1) return std::nullopt;
  const std::chrono::year_month_day day{std::chrono::year{date.year},
                                        std::chrono::month{static_cast<unsigned>(date.month)},
                                        std::chrono::day{static_cast<unsigned>(date.day)}};
  if (!day.ok()) return std::nullopt;
  return kDay_s * static_cast<double>(std::chrono::sys_days{day}.time_since_epoch().count());
}

}  // namespace

std::expected<Timestamp, TimeFault> parse_time(std::string_view text, DateOrder order) {
  constexpr auto kWrong = std::unexpected(TimeFault::kNotATime);
  text = trimmed(text);
  if (const auto number = parse_number(text)) return Timestamp{*number, TimeKind::kSeconds};
  Scanner scanner(text);
  Scanner ahead = scanner;
  const auto date = take_date(order, ahead);
  std::optional<double> day_s;
  if (date) {
    scanner = ahead;
    day_s = seconds_of(*date);
    if (!day_s) return kWrong;
    const bool apart = scanner.take('T') || scanner.take(',') || scanner.rest().starts_with(' ');
    if (!apart) return kWrong;
    scanner.skip_blanks();
  }
  const auto of_day_s = take_clock(scanner);
  if (!of_day_s) return kWrong;
  const auto offset_s = take_zone(scanner);
  if (!scanner.at_end()) return kWrong;
  if (date && date->is_either_way && order == DateOrder::kUnknown) {
    return std::unexpected(TimeFault::kAmbiguousDate);
  }
  const TimeKind local = date ? TimeKind::kLocal : TimeKind::kOfDay;
  const TimeKind utc = date ? TimeKind::kUtc : TimeKind::kUtcOfDay;
  return Timestamp{day_s.value_or(0) + *of_day_s - offset_s.value_or(0), offset_s ? utc : local};
}

DateOrder order_told_by(std::string_view text) {
  Scanner scanner(trimmed(text));
  constexpr std::size_t kMost = 2;  // digits of a day or a month
  constexpr int kMonths = 12;
  if (scanner.digits() > kMost) return DateOrder::kUnknown;
  const auto first = scanner.number(1, kMost);
  if (!first || (!scanner.take('/') && !scanner.take('-'))) return DateOrder::kUnknown;
  const auto second = scanner.number(1, kMost);
  if (!second) return DateOrder::kUnknown;
  if (*first > kMonths) return DateOrder::kDayFirst;
  return *second > kMonths ? DateOrder::kMonthFirst : DateOrder::kUnknown;
}

}  // namespace armsig::tool
