// SPDX-License-Identifier: MIT
// A controller's joint log and a tracker's points, put together: one row a point, or a standstill.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/formats/measurements.hpp"
#include "firmware/formats/timestamp.hpp"
#include "firmware/host_tool/joining/logs.hpp"

namespace armsig::tool {

// By name: a point belongs to the pose of its name; several points of one name repeat it. A point
// A::B::P1 belongs to the pose A::B::P1, B::P1 or P1. By order: the k-th point to the k-th pose. By
// time: a point to the pose logged nearest to it, within `within_s`; the readings of the log must
// stand still there (the rows of the log within that time agree). By standstill: the mean of the
// points while the log stands still, but for the first and last `within_s`, is one row.
enum class JoinBy : std::uint8_t { kName, kOrder, kTime, kStandstill };

struct JoinSettings {
  JoinBy by = JoinBy::kName;
  double within_s = 0.5;
  int target = 1;              // the number of poses whose log does not say
  std::size_t reflectors = 1;  // measured at each pose, one after the other; numbered from `target`
  DateOrder dates = DateOrder::kUnknown;
  std::optional<double> clock_offset_s;  // added to the times of the points
};

struct Joined {
  std::vector<MeasurementRow> rows;      // in the order of the points; sweep 0
  std::vector<std::size_t> points_left;  // lines of points without a pose; none by standstill
  std::size_t poses_left = 0;            // poses, or standstills, without a point
  // By standstill: points that are part of a mean, and standstills whose points moved.
  std::size_t averaged = 0;
  std::size_t moving = 0;
  // What the standstills tell of the clocks, where another offset does better; in words.
  std::string clock_doubt;
};

// Refuses: names that two poses share with different readings or that points of two groups share,
// other counts, times that clock_of() refuses or of two kinds, points of one pose and reflector
// that are not one point, another number of points a pose than of reflectors, nothing that goes
// together. Where two clocks are likely, the standstills tell the offset in the refusal.
[[nodiscard]] Read<Joined> join(const JointLog& log, const TrackedPoints& tracked,
                                const JoinSettings& settings, const JointTypes& types);

// Which joint moved where: a run of rows of one target, at least kShortestSweep, in which one
// joint moves in one direction and all others rest, becomes its sweep. Returns rows of each joint.
inline constexpr std::size_t kShortestSweep = 5;
std::vector<std::size_t> find_sweeps(std::vector<MeasurementRow>& rows, const JointTypes& types);

}  // namespace armsig::tool
