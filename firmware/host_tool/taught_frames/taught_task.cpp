// SPDX-License-Identifier: MIT
#include "firmware/host_tool/taught_frames/taught_task.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

Read<void> take_row(TaughtTask& task, std::size_t k) {
  const TaughtRow& row = task.rows[k];
  const auto problem = [&](std::string what, std::string expected) {
    return std::unexpected(
        Problem{task.file, static_cast<int>(row.line), 0, std::move(what), std::move(expected)});
  };
  auto frame = std::ranges::find(task.frames, row.frame, &TaughtFrame::name);
  if (frame == task.frames.end()) {
    task.frames.push_back({row.frame, row.point->kind, {k}});
    return {};
  }
  if (frame->kind != row.point->kind) {
    return problem(fmt::format("{}: {} is a point of a {}, the points before are of a {}",
                               in_quotes(row.frame), in_quotes(row.point->name),
                               word_of(row.point->kind), word_of(frame->kind)),
                   "another name for each frame");
  }
  for (const std::size_t earlier : frame->rows) {
    if (!std::ranges::equal(task.rows[earlier].q, row.q)) continue;
    return problem(fmt::format("{}: the readings are those of line {}", in_quotes(row.frame),
                               task.rows[earlier].line),
                   "the arm moved between two points of a frame");
  }
  frame->rows.push_back(k);
  return {};
}

}  // namespace

bool TaughtTask::has(TaughtFrameKind kind) const {
  return std::ranges::find(frames, kind, &TaughtFrame::kind) != frames.end();
}

std::optional<std::size_t> TaughtTask::tool_called(std::string_view name) const {
  const auto found = std::ranges::find_if(frames, [&](const TaughtFrame& frame) {
    return frame.kind == TaughtFrameKind::kTool && frame.name == name;
  });
  if (found == frames.end()) return std::nullopt;
  return static_cast<std::size_t>(found - frames.begin());
}

std::vector<std::string> TaughtTask::tool_names() const {
  std::vector<std::string> names;
  for (const TaughtFrame& frame : frames) {
    if (frame.kind == TaughtFrameKind::kTool) names.push_back(frame.name);
  }
  return names;
}

std::string_view word_of(TaughtFrameKind kind) {
  return kind == TaughtFrameKind::kTool ? "tool" : "work object";
}

Read<TaughtTask> taught_task(std::vector<TaughtRow> rows, const std::string& file) {
  TaughtTask task{.file = file, .rows = std::move(rows), .frames = {}, .tip = {}};
  for (std::size_t k = 0; k < task.rows.size(); ++k) {
    if (auto taken = take_row(task, k); !taken) return std::unexpected(std::move(taken).error());
  }
  return task;
}

}  // namespace armsig::tool
