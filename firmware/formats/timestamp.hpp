// SPDX-License-Identifier: MIT
// Times as logs and measuring programs write them.
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string_view>

namespace armsig::tool {

// Only times of one kind can be compared.
enum class TimeKind : std::uint8_t {
  kSeconds,   // a number of seconds of some clock
  kOfDay,     // HH:MM:SS
  kUtcOfDay,  // the same with an offset from UTC, which is taken off: may be below 0 or above a day
  kLocal,     // a date and HH:MM:SS
  kUtc,       // the same with an offset from UTC, which is taken off
};

struct Timestamp {
  double seconds = 0;  // of a date since 1970-01-01
  TimeKind kind = TimeKind::kSeconds;
};

// Of 3/4/2026 and 3-4-2026: which number is the day.
enum class DateOrder : std::uint8_t { kUnknown, kDayFirst, kMonthFirst };

enum class TimeFault : std::uint8_t {
  kNotATime,       // or more than a time
  kAmbiguousDate,  // 3/4/2026 where the order is unknown
};

// A number of seconds; HH:MM:SS with a fraction after a point or a comma, AM or PM; the same after
// a date and a blank, a comma or T: YYYY-MM-DD, YYYY/MM/DD, DD.MM.YYYY, DD-MON-YYYY, or by `order`
// DD/MM/YYYY or MM/DD/YYYY; with Z, UTC or +HH:MM behind it. Second 60 is a leap second. The whole
// of `text` has to be one of these.
[[nodiscard]] std::expected<Timestamp, TimeFault> parse_time(std::string_view text,
                                                             DateOrder order);

// The order that a date itself tells: 13/4/2026 begins with its day. Nothing where it leaves both.
[[nodiscard]] DateOrder order_told_by(std::string_view text);

}  // namespace armsig::tool
