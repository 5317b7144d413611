// SPDX-License-Identifier: MIT
#include "firmware/host_tool/joining/join.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/joining/join_by_time.hpp"
#include "firmware/host_tool/joining/standstills.hpp"

namespace armsig::tool {
namespace {

// No two reflectors are as near to each other, and no arm repeats a pose as badly.
constexpr double kOnePoint_m = 5e-3;

using Partners = std::vector<Partner>;

using NamedPoses = std::map<std::string_view, Partner>;

Read<NamedPoses> poses_by_name(const JointLog& log, const JointTypes& types) {
  NamedPoses named;
  for (const LoggedPose& pose : log.poses) {
    if (pose.name.empty()) {
      return at_line(log.file, pose.line, "the pose has no name",
                     "a column Name or Point, or --by order");
    }
    const auto [known, is_new] = named.try_emplace(pose.name, Partner{&pose, named.size()});
    if (!is_new && !are_same_readings(known->second.pose->q, pose.q, types)) {
      return at_line(log.file, pose.line,
                     fmt::format("{} has other readings than in line {}", in_quotes(pose.name),
                                 known->second.pose->line),
                     "one pose a name");
    }
  }
  return named;
}

// The pose of the whole name, or else of what follows a "::" in it, the longest first.
Partner pose_called(std::string_view name, const NamedPoses& named) {
  constexpr std::string_view kBetween = "::";
  for (;;) {
    const auto found = named.find(name);
    if (found != named.end()) return found->second;
    const std::size_t at = name.find(kBetween);
    if (at == std::string_view::npos) return {};
    name.remove_prefix(at + kBetween.size());
  }
}

Read<Partners> by_name(const JointLog& log, const TrackedPoints& tracked,
                       const JoinSettings& settings, const JointTypes& types) {
  ARMSIG_TRY(named, poses_by_name(log, types));
  std::map<const LoggedPose*, const TrackedPoint*> first_of;
  Partners partners;
  for (const TrackedPoint& point : tracked.points) {
    const Partner partner = pose_called(point.name, named);
    partners.push_back(partner);
    if (partner.pose == nullptr || settings.reflectors > 1) continue;
    const TrackedPoint& first = *first_of.try_emplace(partner.pose, &point).first->second;
    if (first.name == point.name) continue;
    return at_line(
        tracked.file, point.line,
        fmt::format("{} and {} of line {} both go with the pose {}", in_quotes(point.name),
                    in_quotes(first.name), first.line, in_quotes(partner.pose->name)),
        "whole names in the joint log; or --reflectors with how many are measured at "
        "each pose");
  }
  return partners;
}

Read<Partners> by_order(const JointLog& log, const TrackedPoints& tracked,
                        const JoinSettings& settings) {
  const std::size_t poses = log.poses.size();
  const std::size_t points = tracked.points.size();
  if (points != poses * settings.reflectors) {
    const std::size_t each = points / poses;
    const bool several = settings.reflectors == 1 && each > 1 && points % poses == 0;
    return at_line(tracked.file, 0, fmt::format("{} points for {} poses", points, poses),
                   fmt::format("as many of both{}, or --by name or time",
                               several ? fmt::format("; --reflectors {} where so many are measured "
                                                     "at each pose",
                                                     each)
                                       : ""));
  }
  Partners partners;
  for (std::size_t k = 0; k < points; ++k) {
    const std::size_t pose = k / settings.reflectors;
    partners.push_back({&log.poses[pose], pose});
  }
  return partners;
}

// The number of the reflector of each point. Refuses points of one pose that are not one point.
class Reflectors {
 public:
  Reflectors(const TrackedPoints& tracked, const JoinSettings& settings)
      : tracked_(tracked), settings_(settings) {}

  Read<int> number(std::size_t point, const Partner& partner) {
    const TrackedPoint& tracked = tracked_.points[point];
    std::vector<std::size_t>& before = of_pose_[partner.group];
    const auto turn = static_cast<int>(before.size() % settings_.reflectors);
    const auto stated = tracked.target ? tracked.target : partner.pose->target;
    if (tracked.target && partner.pose->target && *tracked.target != *partner.pose->target) {
      return at_line(
          tracked_.file, tracked.line,
          fmt::format("target {}, and {} in the joint log", *tracked.target, *partner.pose->target),
          "one number");
    }
    if (stated && settings_.reflectors > 1) {
      return at_line(tracked_.file, tracked.line, "the files tell the target",
                     "no --reflectors beside a column Target");
    }
    const int number = stated.value_or(settings_.target + turn);
    if (auto same = is_the_same(before, tracked, number); !same) {
      return std::unexpected(std::move(same).error());
    }
    before.push_back(point);
    numbers_[point] = number;
    return number;
  }

  // At each pose all have been measured, once or several times.
  [[nodiscard]] Read<void> finish() const {
    for (const auto& [group, points] : of_pose_) {
      if (points.size() % settings_.reflectors == 0) continue;
      return at_line(tracked_.file, tracked_.points[points.back()].line,
                     fmt::format("the pose of this point has {} points", points.size()),
                     fmt::format("{} at each pose, one a reflector", settings_.reflectors));
    }
    return {};
  }

 private:
  [[nodiscard]] Read<void> is_the_same(const std::vector<std::size_t>& before,
                                       const TrackedPoint& point, int number) const {
    for (const std::size_t other : before) {
      if (numbers_.at(other) != number) continue;
      const double apart_m = (tracked_.points[other].p_S - point.p_S).norm();
      if (apart_m <= kOnePoint_m) return {};
      return at_line(tracked_.file, point.line,
                     fmt::format("this point is {:.1f} mm from that of line {}, of the same pose",
                                 1e3 * apart_m, tracked_.points[other].line),
                     "one point, measured again; or --reflectors with how many are measured at "
                     "each pose");
    }
    return {};
  }

  const TrackedPoints& tracked_;
  const JoinSettings& settings_;
  std::map<std::size_t, std::vector<std::size_t>> of_pose_;  // points, by the group of their pose
  std::map<std::size_t, int> numbers_;                       // by point
};

Read<Joined> rows_of(const JointLog& log, const TrackedPoints& tracked, const Partners& partners,
                     const JoinSettings& settings) {
  Joined joined;
  Reflectors reflectors(tracked, settings);
  std::set<const LoggedPose*> used;
  for (std::size_t k = 0; k < partners.size(); ++k) {
    const TrackedPoint& point = tracked.points[k];
    const LoggedPose* pose = partners[k].pose;
    if (pose == nullptr) {
      joined.points_left.push_back(point.line);
      continue;
    }
    ARMSIG_TRY(number, reflectors.number(k, partners[k]));
    used.insert(pose);
    MeasurementRow row;
    row.line = point.line;
    row.target = number;
    row.q = pose->q;
    row.p_S = point.p_S;
    row.air_c = point.air_c;
    row.sigma_m = point.sigma_m;
    joined.rows.push_back(row);
  }
  if (auto all = reflectors.finish(); !all) return std::unexpected(std::move(all).error());
  joined.poses_left = log.poses.size() - used.size();
  return joined;
}

Read<Joined> joined_by_time(const JointLog& log, const TrackedPoints& tracked,
                            const JoinSettings& settings, const JointTypes& types) {
  ARMSIG_TRY(files, TimedFiles::open(log, tracked, settings, types));
  const bool means = settings.by == JoinBy::kStandstill;
  if (means && settings.reflectors > 1) {
    return at_line(tracked.file, 0, "the mean of points on several reflectors",
                   "one reflector, or --by time, name or order");
  }
  auto joined = means ? Read<Joined>(files.standstill_rows())
                      : rows_of(log, tracked, files.partners(), settings);
  if (!joined) return joined;
  joined->clock_doubt = files.doubt(joined->rows.size());
  if (joined->rows.empty()) {
    return at_line(tracked.file, 0,
                   fmt::format("no point goes with any pose{}{}",
                               joined->clock_doubt.empty() ? "" : "; ", joined->clock_doubt),
                   "times of one clock, while the arm stood still");
  }
  return joined;
}

}  // namespace

Read<Joined> join(const JointLog& log, const TrackedPoints& tracked, const JoinSettings& settings,
                  const JointTypes& types) {
  if (settings.by == JoinBy::kTime || settings.by == JoinBy::kStandstill) {
    return joined_by_time(log, tracked, settings, types);
  }
  ARMSIG_TRY(partners, settings.by == JoinBy::kName ? by_name(log, tracked, settings, types)
                                                    : by_order(log, tracked, settings));
  ARMSIG_TRY(joined, rows_of(log, tracked, partners, settings));
  if (joined.rows.empty()) {
    return at_line(
        tracked.file, 0,
        fmt::format("no point goes with any pose by name: the first is {}, the first pose {}",
                    in_quotes(tracked.points.front().name), in_quotes(log.poses.front().name)),
        "one name in both files, or --by order or time");
  }
  return std::move(joined);
}

}  // namespace armsig::tool
