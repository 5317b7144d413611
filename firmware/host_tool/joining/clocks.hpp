// SPDX-License-Identifier: MIT
// The times of a joint log and of a tracker's points, on one clock.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "firmware/formats/timestamp.hpp"
#include "firmware/host_tool/joining/logs.hpp"

namespace armsig::tool {

// The times of one file, a row each, in seconds.
struct Clock {
  std::string file;
  TimeKind kind = TimeKind::kSeconds;
  std::vector<double> seconds;
};

// `dates`: of dates that are no other way to be read; the file itself may tell (13/4/2026). Of
// times without a date those after midnight are a day later. Refuses a row without a time or with
// another kind of time than the first, dates that are ambiguous or contradict each other, and
// numbers too large for seconds in a column without a unit.
[[nodiscard]] Read<Clock> clock_of(const JointLog& log, DateOrder dates);
[[nodiscard]] Read<Clock> clock_of(const TrackedPoints& points, DateOrder dates);

// Refuses a log that goes back in time: a clock that was set back, as at the end of summer time.
[[nodiscard]] Read<void> check_order(const JointLog& log, const Clock& clock);

// Whether the times of two files can be compared.
[[nodiscard]] bool are_of_one_kind(const Clock& log, const Clock& points);
[[nodiscard]] std::string_view word_of(TimeKind kind);

// Of times without a date: moves `points` by the whole days after which most of them are within
// `log`, for files that begin on different days.
void align_days(const Clock& log, Clock& points);

// A time in which the arm, or the point, stood still.
struct Standstill {
  double from_s = 0;
  double to_s = 0;
  std::size_t first = 0;  // rows, as they are in order of time
  std::size_t last = 0;   // the last of them
};

// What has to be added to the times of `events` for most of them to be in standstills.
struct ClockOffset {
  double seconds = 0;
  std::size_t agreeing = 0;   // events that are in a standstill then
  std::size_t of = 0;         // events
  std::size_t next_best = 0;  // agreeing with any other offset
};

// Nothing where fewer than four fifths agree, or another offset does as well: standstills that
// follow each other evenly leave it open, but for as many events as standstills. Both ascending;
// the first 1,000 of each are used.
[[nodiscard]] std::optional<ClockOffset> find_clock_offset(std::span<const Standstill> standstills,
                                                           std::span<const double> events);

}  // namespace armsig::tool
