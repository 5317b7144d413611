// SPDX-License-Identifier: MIT
// A controller's joint log and a tracker's points, as rows.
#pragma once

#include <cstddef>
#include <expected>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/pose.hpp"
#include "firmware/formats/foreign_header.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

// A problem with a line of a file, or with all of it where that is 0.
[[nodiscard]] inline std::unexpected<Problem> at_line(const std::string& file, std::size_t line,
                                                      std::string what, std::string expected) {
  return std::unexpected(
      Problem{file, static_cast<int>(line), 0, std::move(what), std::move(expected)});
}

// As a log has it.
struct LoggedTime {
  std::string text;               // with its date, where that has a column of its own
  std::optional<double> seconds;  // where it is a number, by the unit of its column
  bool has_unit = false;          // the column states one
};

// One row of the joint log.
struct LoggedPose {
  std::size_t line = 0;
  std::string name;  // empty: none; with group and collection, A::B::P1, where they have columns
  LoggedTime time;
  std::optional<int> target;
  JointVector q;
};

struct TrackedPoint {
  std::size_t line = 0;
  std::string name;  // as above
  LoggedTime time;
  std::optional<int> target;
  Vector3 p_S = Vector3::Zero();
  std::optional<double> air_c;
  std::optional<double> sigma_m;
};

struct JointLog {
  std::string file;
  std::vector<LoggedPose> poses;
  std::string unused;  // columns that nothing is made of, in words; empty: none
};

struct TrackedPoints {
  std::string file;
  std::vector<TrackedPoint> points;
  std::string unused;
};

// `columns`: as wanted_of() has it. Refuses what layout_of() and row_cells() refuse, numbers that
// could have a thousands separator, more than 64 MiB or a million rows.
[[nodiscard]] Read<JointLog> read_joint_log(const std::string& path, const NamedJoints& joints,
                                            const StatedUnits& units,
                                            std::string_view columns = "auto");
[[nodiscard]] Read<TrackedPoints> read_tracked_points(const std::string& path,
                                                      const StatedUnits& units,
                                                      std::string_view columns = "auto");

}  // namespace armsig::tool
