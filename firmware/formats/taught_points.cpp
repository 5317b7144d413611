// SPDX-License-Identifier: MIT
#include "firmware/formats/taught_points.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/csv_table.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

const TaughtPoint* point_called(std::string_view name) {
  const auto* found = std::ranges::find(kTaughtPoints, name, &TaughtPoint::name);
  return found == kTaughtPoints.end() ? nullptr : found;
}

std::string known_points() {
  const auto names_of_kind = [](TaughtFrameKind kind) {
    std::vector<std::string> names;
    for (const TaughtPoint& point : kTaughtPoints) {
      if (point.kind == kind) names.emplace_back(point.name);
    }
    return any_of(names);
  };
  return fmt::format("{} of a tool; {} of a work object", names_of_kind(TaughtFrameKind::kTool),
                     names_of_kind(TaughtFrameKind::kWorkObject));
}

// The frame and the point of the row that `table` is at.
Read<TaughtRow> taught_row(const CsvTable& table, std::size_t joints) {
  const std::size_t frame = joints;
  const std::size_t point = joints + 1;
  TaughtRow row{.line = table.line(),
                .frame = std::string(table.field(frame)),
                .point = point_called(table.field(point)),
                .q = JointVector(joints)};
  if (row.frame.empty()) return table.problem(frame, "a frame without a name", "a name");
  if (auto why = why_no_name(row.frame)) {
    return table.problem(frame, *std::move(why), std::string(kNameExpected));
  }
  if (row.point == nullptr) {
    return table.problem(point, fmt::format("unknown point {}", in_quotes(table.field(point))),
                         known_points());
  }
  for (std::size_t i = 0; i < joints; ++i) row.q[i] = table.value(i);
  return row;
}

Read<std::vector<TaughtRow>> taught_rows_from(LineReader lines, const JointTypes& types) {
  std::vector<Quantity> quantities = joint_quantities(types);
  quantities.push_back({.name = "frame", .dimension = Dimension::kText});
  quantities.push_back({.name = "point", .dimension = Dimension::kText});
  ARMSIG_TRY(table, CsvTable::open(std::move(lines), std::move(quantities)));
  std::vector<TaughtRow> rows;
  for (;;) {
    ARMSIG_TRY(more, table.next());
    if (!more) break;
    if (rows.size() == kMostTaughtRows) {
      return table.problem(fmt::format("more than {} rows", kMostTaughtRows),
                           "taught points, not a log");
    }
    ARMSIG_TRY(row, taught_row(table, types.size()));
    rows.push_back(std::move(row));
  }
  if (rows.empty()) return table.problem("the file ends after its header", "rows of taught points");
  return rows;
}

}  // namespace

Read<TaughtTable> read_taught_points(const std::string& path, const std::string& columns,
                                     const NamedJoints& joints) {
  if (columns.empty()) {
    ARMSIG_TRY(lines, LineReader::open(path));
    ARMSIG_TRY(rows, taught_rows_from(std::move(lines), joints.types));
    return TaughtTable{std::move(rows), {}};
  }
  ARMSIG_TRY(mapped, map_taught_points(path, columns, joints));
  auto rows =
      taught_rows_from(LineReader::over(mapped.text, path, mapped.first_line), joints.types);
  if (rows) return TaughtTable{*std::move(rows), in_words(mapped)};
  rows.error().column = 0;  // of the mapped line, not of the file's
  return std::unexpected(std::move(rows).error());
}

Read<std::vector<TaughtRow>> parse_taught_points(std::string_view text, std::string_view file,
                                                 const JointTypes& types) {
  return taught_rows_from(LineReader::over(text, file), types);
}

}  // namespace armsig::tool
