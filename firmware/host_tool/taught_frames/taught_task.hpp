// SPDX-License-Identifier: MIT
// Taught points by the frames that they teach.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/pose.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/taught_points.hpp"

namespace armsig::tool {

struct TaughtFrame {
  std::string name;
  TaughtFrameKind kind = TaughtFrameKind::kTool;
  std::vector<std::size_t> rows;  // of the task, in the order of the file
};

// What touched the points of the work objects.
struct TouchingTip {
  std::optional<std::size_t> frame;  // a tool of the same file
  Vector3 t_E = Vector3::Zero();     // on the controller's flange, where it is no such tool
  std::string words;                 // "tool torch"
};

struct TaughtTask {
  std::string file;
  std::vector<TaughtRow> rows;
  std::vector<TaughtFrame> frames;  // in the order of their first rows
  TouchingTip tip;

  [[nodiscard]] bool has(TaughtFrameKind kind) const;
  [[nodiscard]] std::optional<std::size_t> tool_called(std::string_view name) const;
  [[nodiscard]] std::vector<std::string> tool_names() const;
};

// "tool" or "work object".
[[nodiscard]] std::string_view word_of(TaughtFrameKind kind);

// Refuses a frame with points of a tool and of a work object, and two rows of a frame with the same
// readings.
[[nodiscard]] Read<TaughtTask> taught_task(std::vector<TaughtRow> rows, const std::string& file);

}  // namespace armsig::tool
