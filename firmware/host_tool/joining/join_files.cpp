// SPDX-License-Identifier: MIT
#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/joining/join.hpp"
#include "firmware/host_tool/joining/timestamp.hpp"

namespace armsig::tool {
namespace {

std::string field_of(const ForeignRow& row, const std::optional<std::size_t>& column) {
  return column && *column < row.fields.size() ? row.fields[*column] : std::string{};
}

LoggedTime time_of(const ForeignRow& row, const std::optional<std::size_t>& column) {
  const std::string field = field_of(row, column);
  return {field, field.empty() ? std::nullopt : seconds_of(field)};
}

// The rows below the header; `expected`: what stands in each.
Read<std::span<const ForeignRow>> data_of(const ForeignTable& table, const Columns& columns,
                                          const char* expected) {
  const auto rows = std::span(table.rows).subspan(columns.first_row);
  if (!rows.empty()) return rows;
  return std::unexpected(Problem{table.file, static_cast<int>(table.rows.back().line), 0,
                                 "no rows below the header", expected});
}

Read<LoggedPose> logged_pose(const ForeignTable& table, const ForeignRow& row,
                             const Columns& columns) {
  LoggedPose pose{.line = row.line,
                  .name = field_of(row, columns.name),
                  .time = time_of(row, columns.time),
                  .target = {},
                  .q = {}};
  if (const std::string number = field_of(row, columns.target); !number.empty()) {
    pose.target = parse_integer(number);
    // A target that is no number is the name of the point.
    if (!pose.target && pose.name.empty()) pose.name = number;
  }
  for (const NumberColumn& column : columns.joints) {
    ARMSIG_TRY(reading, number_of(table, row, column));
    pose.q.push_back(reading);
  }
  return pose;
}

Read<TrackedPoint> tracked_point(const ForeignTable& table, const ForeignRow& row,
                                 const Columns& columns) {
  TrackedPoint point{
      .line = row.line, .name = field_of(row, columns.name), .time = time_of(row, columns.time)};
  if (point.name.empty()) point.name = field_of(row, columns.target);
  for (int i = 0; i < 3; ++i) {
    ARMSIG_TRY(coordinate, number_of(table, row, (*columns.position)[static_cast<std::size_t>(i)]));
    point.p_S[i] = coordinate;
  }
  return point;
}

}  // namespace

Read<std::vector<LoggedPose>> read_joint_log(const std::string& path, const JointTypes& types,
                                             const StatedUnits& units) {
  ARMSIG_TRY(table, read_foreign_table(path));
  ARMSIG_TRY(columns, columns_of(table, types, units));
  if (columns.joints.empty()) {
    return std::unexpected(Problem{
        path, static_cast<int>(table.rows.front().line), 0,
        fmt::format("no header with the readings of {} joints and their units", types.size()),
        "such as A1 [deg] or q1_deg, or A1 and --units deg,mm"});
  }
  ARMSIG_TRY(rows, data_of(table, columns, "a row for each pose, with the joints' readings"));
  std::vector<LoggedPose> poses;
  for (const ForeignRow& row : rows) {
    ARMSIG_TRY(pose, logged_pose(table, row, columns));
    poses.push_back(pose);
  }
  return poses;
}

Read<std::vector<TrackedPoint>> read_tracked_points(const std::string& path,
                                                    const JointTypes& types,
                                                    const StatedUnits& units) {
  ARMSIG_TRY(table, read_foreign_table(path));
  ARMSIG_TRY(columns, columns_of(table, types, units));
  if (!columns.position) {
    return std::unexpected(Problem{path, static_cast<int>(table.rows.front().line), 0,
                                   "no header with x, y, z and their unit",
                                   "such as X [mm], or X and --units mm"});
  }
  ARMSIG_TRY(rows, data_of(table, columns, "a row for each point, with its position"));
  std::vector<TrackedPoint> points;
  for (const ForeignRow& row : rows) {
    ARMSIG_TRY(point, tracked_point(table, row, columns));
    points.push_back(point);
  }
  return points;
}

}  // namespace armsig::tool
