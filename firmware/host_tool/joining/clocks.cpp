// SPDX-License-Identifier: MIT
#include "firmware/host_tool/joining/clocks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

constexpr double kDay_s = 86400;
// In the year 5138: a number as large as this counts milliseconds or less.
constexpr double kLargestSeconds = 1e11;

struct TimedRow {
  std::size_t line = 0;
  const LoggedTime* time = nullptr;
};

Read<DateOrder> order_of(const std::string& file, std::span<const TimedRow> rows,
                         DateOrder stated) {
  DateOrder order = stated;
  for (const TimedRow& row : rows) {
    const DateOrder told = order_told_by(row.time->text);
    if (told == DateOrder::kUnknown) continue;
    if (order != DateOrder::kUnknown && told != order) {
      return at_line(
          file, row.line,
          fmt::format("{} is of another order of day and month than {}", in_quotes(row.time->text),
                      stated == DateOrder::kUnknown ? "the rows before" : "--dates"),
          "one order in all rows: --dates day-first or month-first");
    }
    order = told;
  }
  return order;
}

Read<Timestamp> time_of(const std::string& file, const TimedRow& row, DateOrder order) {
  const LoggedTime& time = *row.time;
  if (time.text.empty()) return at_line(file, row.line, "no time", "a column Time in every row");
  if (time.seconds) {
    if (!time.has_unit && std::abs(*time.seconds) >= kLargestSeconds) {
      return at_line(file, row.line, fmt::format("{} is no time in seconds", in_quotes(time.text)),
                     "its unit in the header: Time [ms], Time [us] or Time [ns]");
    }
    return Timestamp{*time.seconds, TimeKind::kSeconds};
  }
  const auto parsed = parse_time(time.text, order);
  if (parsed && !time.has_unit) return *parsed;
  if (!parsed && parsed.error() == TimeFault::kAmbiguousDate) {
    return at_line(file, row.line,
                   fmt::format("{} may begin with its day or with its month", in_quotes(time.text)),
                   "--dates day-first or month-first; or dates such as 2026-05-12");
  }
  return at_line(file, row.line, in_quotes(time.text),
                 time.has_unit ? "a number, as the header states its unit"
                               : "seconds, HH:MM:SS (AM or PM), YYYY-MM-DD HH:MM:SS, "
                                 "DD.MM.YYYY HH:MM:SS, or one of these with Z or +HH:MM behind it");
}

Read<Clock> clock_from(const std::string& file, std::span<const TimedRow> rows, DateOrder dates) {
  ARMSIG_TRY(order, order_of(file, rows, dates));
  Clock clock{.file = file, .kind = TimeKind::kSeconds, .seconds = {}};
  clock.seconds.reserve(rows.size());
  double days_s = 0;
  for (const TimedRow& row : rows) {
    ARMSIG_TRY(time, time_of(file, row, order));
    if (clock.seconds.empty()) clock.kind = time.kind;
    if (time.kind != clock.kind) {
      return at_line(file, row.line,
                     fmt::format("{} is {}, the time of line {} {}", in_quotes(row.time->text),
                                 word_of(time.kind), rows.front().line, word_of(clock.kind)),
                     "times of one kind");
    }
    const bool repeats = clock.kind == TimeKind::kOfDay || clock.kind == TimeKind::kUtcOfDay;
    const bool midnight = repeats && !clock.seconds.empty() &&
                          time.seconds + days_s < clock.seconds.back() - kDay_s / 2;
    if (midnight) days_s += kDay_s;
    clock.seconds.push_back(time.seconds + days_s);
  }
  return clock;
}

// How many of `points`, moved, are between the first and the last time of `log`.
std::size_t within(const Clock& log, const Clock& points, double offset_s) {
  const auto [first, last] = std::ranges::minmax(log.seconds);
  return static_cast<std::size_t>(std::ranges::count_if(points.seconds, [&](double seconds) {
    return seconds + offset_s >= first && seconds + offset_s <= last;
  }));
}

// At an offset from `at` on so many events more, or fewer, are in a standstill.
struct Edge {
  double at = 0;
  int step = 0;
};

std::vector<Edge> edges_of(std::span<const Standstill> standstills,
                           std::span<const double> events) {
  std::vector<Edge> edges;
  edges.reserve(2 * standstills.size() * events.size());
  for (const double event : events) {
    for (const Standstill& still : standstills) {
      edges.push_back({still.from_s - event, 1});
      edges.push_back({still.to_s - event, -1});
    }
  }
  // At one offset those that come go before those that leave.
  std::ranges::sort(edges, [](const Edge& a, const Edge& b) {
    return a.at < b.at || (a.at == b.at && a.step > b.step);
  });
  return edges;
}

}  // namespace

Read<Clock> clock_of(const JointLog& log, DateOrder dates) {
  std::vector<TimedRow> rows;
  rows.reserve(log.poses.size());
  for (const LoggedPose& pose : log.poses) rows.push_back({pose.line, &pose.time});
  return clock_from(log.file, rows, dates);
}

Read<Clock> clock_of(const TrackedPoints& points, DateOrder dates) {
  std::vector<TimedRow> rows;
  rows.reserve(points.points.size());
  for (const TrackedPoint& point : points.points) rows.push_back({point.line, &point.time});
  return clock_from(points.file, rows, dates);
}

Read<void> check_order(const JointLog& log, const Clock& clock) {
  for (std::size_t k = 1; k < clock.seconds.size(); ++k) {
    if (clock.seconds[k] >= clock.seconds[k - 1]) continue;
    return at_line(
        log.file, log.poses[k].line,
        fmt::format("the time goes back by {:.3f} s from line {} to this one",
                    clock.seconds[k - 1] - clock.seconds[k], log.poses[k - 1].line),
        "rows in the order of time; times with Z or +HH:MM where the clock was set back");
  }
  return {};
}

bool are_of_one_kind(const Clock& log, const Clock& points) { return log.kind == points.kind; }

std::string_view word_of(TimeKind kind) {
  switch (kind) {
    case TimeKind::kSeconds:
      return "a number of seconds";
    case TimeKind::kOfDay:
      return "a time of day";
    case TimeKind::kUtcOfDay:
      return "a time of day with its offset from UTC";
    case TimeKind::kLocal:
      return "a date and time";
    case TimeKind::kUtc:
      return "a date and time with its offset from UTC";
  }
  return "";
}

void align_days(const Clock& log, Clock& points) {
  if (points.kind != TimeKind::kOfDay && points.kind != TimeKind::kUtcOfDay) return;
  double best_s = 0;
  for (const double offset_s : {-kDay_s, kDay_s}) {
    if (within(log, points, offset_s) > within(log, points, best_s)) best_s = offset_s;
  }
  for (double& seconds : points.seconds) seconds += best_s;
}

std::optional<ClockOffset> find_clock_offset(std::span<const Standstill> standstills,
                                             std::span<const double> events) {
  constexpr std::size_t kMost = 1000;
  constexpr std::size_t kFewest = 3;
  standstills = standstills.first(std::min(standstills.size(), kMost));
  events = events.first(std::min(events.size(), kMost));
  if (standstills.size() < kFewest || events.size() < kFewest) return std::nullopt;
  const std::vector<Edge> edges = edges_of(standstills, events);
  int inside = 0;
  int best = 0;
  double from_s = 0;
  double to_s = 0;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    inside += edges[k].step;
    if (inside <= best) continue;
    best = inside;
    from_s = edges[k].at;
    to_s = edges[k + 1].at;
  }
  // Beside the best offset points slip out of their standstills one by one.
  double beside_s = 0;
  for (const Standstill& still : standstills)
    beside_s = std::max(beside_s, still.to_s - still.from_s);
  int next_best = 0;
  inside = 0;
  for (const Edge& edge : edges) {
    inside += edge.step;
    const bool apart = edge.at > to_s + beside_s || edge.at < from_s - beside_s;
    if (apart) next_best = std::max(next_best, inside);
  }
  const auto agreeing = static_cast<std::size_t>(best);
  if (agreeing < kFewest || 5 * agreeing < 4 * events.size() || next_best >= best) {
    return std::nullopt;
  }
  return ClockOffset{(from_s + to_s) / 2, agreeing, events.size(),
                     static_cast<std::size_t>(next_best)};
}

}  // namespace armsig::tool
