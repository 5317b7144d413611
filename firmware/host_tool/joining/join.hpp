// SPDX-License-Identifier: MIT
// A controller's joint log and a tracker's points, put together: one row a point.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/formats/measurements.hpp"
#include "firmware/host_tool/joining/columns.hpp"

namespace armsig::tool {

// As a log has it, and what it stands for: nothing where that is not understood.
struct LoggedTime {
  std::string text;
  std::optional<double> seconds;
};

// One row of the joint log.
struct LoggedPose {
  std::size_t line = 0;
  std::string name;  // empty: none
  LoggedTime time;
  std::optional<int> target;
  JointVector q;
};

struct TrackedPoint {
  std::size_t line = 0;
  std::string name;
  LoggedTime time;
  Vector3 p_S = Vector3::Zero();
};

[[nodiscard]] Read<std::vector<LoggedPose>> read_joint_log(const std::string& path,
                                                           const JointTypes& types,
                                                           const StatedUnits& units);
[[nodiscard]] Read<std::vector<TrackedPoint>> read_tracked_points(const std::string& path,
                                                                  const JointTypes& types,
                                                                  const StatedUnits& units);

enum class JoinBy : std::uint8_t { kName, kOrder, kTime };

struct JoinFiles {
  std::string joints;
  std::string points;
};

struct Joined {
  std::vector<MeasurementRow> rows;      // in the order of the points; sweep 0
  std::vector<std::size_t> points_left;  // lines of points without a pose
  std::size_t poses_left = 0;            // poses without a point
};

// By name: a point belongs to the pose of its name; several points of one name repeat it. By order:
// the k-th point to the k-th pose, of which there must be as many. By time: a point to the pose
// logged nearest to it, within `within_s`; the readings of the log must stand still there (the rows
// of the log within that time agree). `target`: the number of poses whose log does not say.
// Refuses: names that two poses share with different readings, other counts, no time, nothing that
// goes together.
[[nodiscard]] Read<Joined> join(const std::vector<LoggedPose>& poses,
                                const std::vector<TrackedPoint>& points, JoinBy by, double within_s,
                                int target, const JoinFiles& files, const JointTypes& types);

// Which joint moved where: a run of rows of one target, at least kShortestSweep, in which one
// joint moves in one direction and all others rest, becomes its sweep. Returns rows of each joint.
inline constexpr std::size_t kShortestSweep = 5;
std::vector<std::size_t> find_sweeps(std::vector<MeasurementRow>& rows, const JointTypes& types);

}  // namespace armsig::tool
