// SPDX-License-Identifier: MIT
#include "firmware/host_tool/joining/join_by_time.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/host_tool/joining/standstills.hpp"

namespace armsig::tool {
namespace {

// Points of one standstill that are farther from their mean belong to a point that moved.
constexpr double kMoved_m = 1e-3;

}  // namespace

Read<TimedFiles> TimedFiles::open(const JointLog& log, const TrackedPoints& tracked,
                                  const JoinSettings& settings, const JointTypes& types) {
  TimedFiles files(log, tracked, settings, types);
  ARMSIG_TRY(poses, clock_of(log, settings.dates));
  ARMSIG_TRY(points, clock_of(tracked, settings.dates));
  if (auto order = check_order(log, poses); !order) return std::unexpected(order.error());
  files.poses_ = std::move(poses);
  files.points_ = std::move(points);
  files.standstills_ = standstills_of(log.poses, files.poses_, types);
  const bool comparable = are_of_one_kind(files.poses_, files.points_);
  if (!comparable && !settings.clock_offset_s) {
    const std::string doubt = files.doubt(0);
    return std::unexpected(Problem{
        tracked.file, static_cast<int>(tracked.points.front().line), 0,
        fmt::format("{}, and in {} {}{}{}", word_of(files.points_.kind), log.file,
                    word_of(files.poses_.kind), doubt.empty() ? "" : ": ", doubt),
        "times of one kind in both files; or --clock-offset-s with what is added to the points'"});
  }
  for (double& seconds : files.points_.seconds) seconds += settings.clock_offset_s.value_or(0);
  if (comparable) align_days(files.poses_, files.points_);
  return files;
}

std::vector<Partner> TimedFiles::partners() const {
  std::vector<std::size_t> group_of(log_.poses.size());
  for (std::size_t g = 0; g < standstills_.size(); ++g) {
    for (std::size_t k = standstills_[g].first; k <= standstills_[g].last; ++k) group_of[k] = g;
  }
  std::vector<Partner> partners;
  partners.reserve(tracked_.points.size());
  const std::vector<double>& times = poses_.seconds;
  for (const double at_s : points_.seconds) {
    const auto first = std::ranges::lower_bound(times, at_s - settings_.within_s);
    const auto last = std::ranges::upper_bound(times, at_s + settings_.within_s);
    const auto nearest = std::min_element(
        first, last, [&](double a, double b) { return std::abs(a - at_s) < std::abs(b - at_s); });
    const auto index = [&](auto place) { return static_cast<std::size_t>(place - times.begin()); };
    bool stands = nearest != last;
    for (std::size_t k = index(first); stands && k < index(last); ++k) {
      stands = are_same_readings(log_.poses[k].q, log_.poses[index(nearest)].q, types_);
    }
    partners.push_back(stands ? Partner{&log_.poses[index(nearest)], group_of[index(nearest)]}
                              : Partner{});
  }
  return partners;
}

MeasurementRow TimedFiles::pose_of(const Standstill& still) const {
  const LoggedPose& pose = log_.poses[still.first];
  MeasurementRow row;
  row.target = pose.target.value_or(settings_.target);
  row.q = pose.q;
  for (std::size_t k = still.first + 1; k <= still.last; ++k) {
    for (std::size_t j = 0; j < row.q.size(); ++j) row.q[j] += log_.poses[k].q[j];
  }
  for (double& reading : row.q) reading /= static_cast<double>(still.last - still.first + 1);
  return row;
}

std::optional<Vector3> TimedFiles::mean_of(std::span<const std::size_t> points) const {
  Vector3 mean_S = Vector3::Zero();
  for (const std::size_t k : points) mean_S += tracked_.points[k].p_S;
  mean_S /= static_cast<double>(points.size());
  const bool moved = std::ranges::any_of(
      points, [&](std::size_t k) { return (tracked_.points[k].p_S - mean_S).norm() > kMoved_m; });
  return moved ? std::nullopt : std::optional(mean_S);
}

Joined TimedFiles::standstill_rows() const {
  std::vector<std::size_t> order(tracked_.points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto time = [&](std::size_t k) { return points_.seconds[k]; };
  std::ranges::stable_sort(order, {}, time);
  Joined joined;
  for (const Standstill& still : usable(standstills_, settings_.within_s)) {
    const std::span<const std::size_t> during(
        std::ranges::lower_bound(order, still.from_s, {}, time),
        std::ranges::upper_bound(order, still.to_s, {}, time));
    if (during.empty()) {
      ++joined.poses_left;
      continue;
    }
    MeasurementRow row = pose_of(still);
    row.line = tracked_.points[during.front()].line;
    row.p_S = mean_of(during);
    if (!row.p_S) {
      ++joined.moving;
      continue;
    }
    joined.averaged += during.size();
    joined.rows.push_back(row);
  }
  return joined;
}

std::string TimedFiles::doubt(std::size_t agreeing) const {
  const std::vector<Standstill> still = usable(standstills_, settings_.within_s);
  const std::vector<double> events =
      events_of(tracked_.points, points_, still.size(), settings_.within_s);
  const auto found = find_clock_offset(still, events);
  if (!found || found->agreeing <= agreeing) return {};
  const double offset_s = found->seconds + settings_.clock_offset_s.value_or(0);
  return fmt::format(
      "the standstills tell of two clocks: with --clock-offset-s {:.3f} {} of {} {} are in a "
      "standstill of the arm, with any other at most {}",
      offset_s, found->agreeing, found->of,
      events.size() == tracked_.points.size() ? "points" : "standstills of the point",
      found->next_best);
}

}  // namespace armsig::tool
