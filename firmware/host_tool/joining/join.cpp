// SPDX-License-Identifier: MIT
#include "firmware/host_tool/joining/join.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

// Readings nearer than this are one pose: 0.01 degrees, or 0.05 mm of a slide.
double tolerance_of(JointType type) { return type == JointType::kRevolute ? radians(0.01) : 5e-5; }

bool same_readings(const JointVector& a, const JointVector& b, const JointTypes& types) {
  for (std::size_t j = 0; j < types.size(); ++j) {
    if (std::abs(a[j] - b[j]) > tolerance_of(types[j])) return false;
  }
  return true;
}

MeasurementRow row_of(const LoggedPose& pose, const TrackedPoint& point, int target) {
  MeasurementRow row;
  row.line = point.line;
  row.target = pose.target.value_or(target);
  row.q = pose.q;
  row.p_S = point.p_S;
  return row;
}

std::unexpected<Problem> at_line(const std::string& file, std::size_t line, std::string what,
                                 std::string expected) {
  return std::unexpected(
      Problem{file, static_cast<int>(line), 0, std::move(what), std::move(expected)});
}

std::unexpected<Problem> no_time(const std::string& file, std::size_t line,
                                 const LoggedTime& time) {
  if (time.text.empty()) return at_line(file, line, "no time", "a column Time in every row");
  return at_line(file, line, in_quotes(time.text),
                 "seconds, HH:MM:SS, YYYY-MM-DD HH:MM:SS, or DD.MM.YYYY HH:MM:SS");
}

// The pose of each point; null: none.
using Partners = std::vector<const LoggedPose*>;

Read<Partners> by_name(const std::vector<LoggedPose>& poses,
                       const std::vector<TrackedPoint>& points, const JoinFiles& files,
                       const JointTypes& types) {
  std::map<std::string_view, const LoggedPose*> named;
  for (const LoggedPose& pose : poses) {
    if (pose.name.empty()) {
      return at_line(files.joints, pose.line, "the pose has no name",
                     "a column Name or Point, or --by order");
    }
    const auto [known, is_new] = named.try_emplace(pose.name, &pose);
    if (!is_new && !same_readings(known->second->q, pose.q, types)) {
      return at_line(files.joints, pose.line,
                     fmt::format("{} has other readings than in line {}", in_quotes(pose.name),
                                 known->second->line),
                     "one pose a name");
    }
  }
  Partners partners;
  for (const TrackedPoint& point : points) {
    const auto found = named.find(point.name);
    partners.push_back(found == named.end() ? nullptr : found->second);
  }
  return partners;
}

Read<Partners> by_order(const std::vector<LoggedPose>& poses,
                        const std::vector<TrackedPoint>& points, const JoinFiles& files) {
  if (poses.size() != points.size()) {
    return at_line(files.points, 0,
                   fmt::format("{} points for {} poses", points.size(), poses.size()),
                   "as many of both, or --by name or time");
  }
  Partners partners;
  for (const LoggedPose& pose : poses) partners.push_back(&pose);
  return partners;
}

Read<Partners> by_time(const std::vector<LoggedPose>& poses,
                       const std::vector<TrackedPoint>& points, double within_s,
                       const JoinFiles& files, const JointTypes& types) {
  std::vector<const LoggedPose*> sorted;
  for (const LoggedPose& pose : poses) {
    if (!pose.time.seconds) return no_time(files.joints, pose.line, pose.time);
    sorted.push_back(&pose);
  }
  std::ranges::sort(sorted, {}, [](const LoggedPose* pose) {
    return std::pair(*pose->time.seconds, pose->line);
  });
  Partners partners;
  for (const TrackedPoint& point : points) {
    if (!point.time.seconds) return no_time(files.points, point.line, point.time);
    const auto time = [](const LoggedPose* pose) { return *pose->time.seconds; };
    const auto first = std::ranges::lower_bound(sorted, *point.time.seconds - within_s, {}, time);
    const auto last = std::ranges::upper_bound(sorted, *point.time.seconds + within_s, {}, time);
    const auto nearest = std::min_element(first, last, [&](const auto* a, const auto* b) {
      return std::abs(*a->time.seconds - *point.time.seconds) <
             std::abs(*b->time.seconds - *point.time.seconds);
    });
    const bool stands = nearest != last && std::all_of(first, last, [&](const LoggedPose* pose) {
                          return same_readings(pose->q, (*nearest)->q, types);
                        });
    partners.push_back(stands ? *nearest : nullptr);
  }
  return partners;
}

}  // namespace

Read<Joined> join(const std::vector<LoggedPose>& poses, const std::vector<TrackedPoint>& points,
                  JoinBy by, double within_s, int target, const JoinFiles& files,
                  const JointTypes& types) {
  ARMSIG_TRY(partners, by == JoinBy::kName    ? by_name(poses, points, files, types)
                       : by == JoinBy::kOrder ? by_order(poses, points, files)
                                              : by_time(poses, points, within_s, files, types));
  Joined joined;
  std::vector<const LoggedPose*> used;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (partners[k] == nullptr) {
      joined.points_left.push_back(points[k].line);
      continue;
    }
    used.push_back(partners[k]);
    joined.rows.push_back(row_of(*partners[k], points[k], target));
  }
  if (joined.rows.empty()) {
    if (by != JoinBy::kName) {
      return at_line(files.points, 0, "no point goes with any pose",
                     "times of one clock, while the arm stood still");
    }
    return at_line(
        files.points, 0,
        fmt::format("no point goes with any pose by name: the first is {}, the first pose {}",
                    in_quotes(points.front().name), in_quotes(poses.front().name)),
        "one name in both files, or --by order or time");
  }
  std::ranges::sort(used);
  const auto repeated = std::ranges::unique(used);
  joined.poses_left = poses.size() - (used.size() - repeated.size());
  return joined;
}

}  // namespace armsig::tool
