// SPDX-License-Identifier: MIT
// Taught points (CSV): joint readings with the frame that they teach and the point of it
// (docs/formats.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/arm.hpp"
#include "firmware/formats/foreign_columns.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

enum class TaughtFrameKind : std::uint8_t { kTool, kWorkObject };

// What the arm did where the readings were taken.
struct TaughtPoint {
  std::string_view name;
  TaughtFrameKind kind = TaughtFrameKind::kTool;
  // The point has these coordinates zero in the frame. Of a tool's direction they are those of the
  // fixed tip, with the axis that it is on.
  std::array<bool, 3> zero{};
  int axis = -1;  // 0, 1, 2 of a point on an axis; -1: the origin, a tip, a point of a plane
  int sign = 1;   // of the coordinate along it
};

inline constexpr std::array<TaughtPoint, 11> kTaughtPoints{{
    {"tip", TaughtFrameKind::kTool, {true, true, true}, -1, 1},
    {"x+", TaughtFrameKind::kTool, {false, true, true}, 0, 1},
    {"x-", TaughtFrameKind::kTool, {false, true, true}, 0, -1},
    {"y+", TaughtFrameKind::kTool, {true, false, true}, 1, 1},
    {"y-", TaughtFrameKind::kTool, {true, false, true}, 1, -1},
    {"z+", TaughtFrameKind::kTool, {true, true, false}, 2, 1},
    {"z-", TaughtFrameKind::kTool, {true, true, false}, 2, -1},
    {"origin", TaughtFrameKind::kWorkObject, {true, true, true}, -1, 1},
    {"x", TaughtFrameKind::kWorkObject, {false, true, true}, 0, 1},
    {"y", TaughtFrameKind::kWorkObject, {true, false, true}, 1, 1},
    {"xy", TaughtFrameKind::kWorkObject, {false, false, true}, -1, 1},
}};

struct TaughtRow {
  std::size_t line = 0;  // of the file, from 1
  std::string frame;
  const TaughtPoint* point = nullptr;  // of kTaughtPoints
  JointVector q;                       // as read: couplings not applied
};

// Reads `path`; with `columns`, a mapping of other software's columns, what that makes of it, which
// goes to `mapped`. Refuses a frame without a name, a point that is none of kTaughtPoints, more
// rows than kMostTaughtRows, and a file without any row.
inline constexpr std::size_t kMostTaughtRows = 500;
struct TaughtTable {
  std::vector<TaughtRow> rows;
  std::string mapped;  // which columns became which, in words; empty without a mapping
};
[[nodiscard]] Read<TaughtTable> read_taught_points(const std::string& path,
                                                   const std::string& columns,
                                                   const NamedJoints& joints);
[[nodiscard]] Read<std::vector<TaughtRow>> parse_taught_points(std::string_view text,
                                                               std::string_view file,
                                                               const JointTypes& types);

}  // namespace armsig::tool
