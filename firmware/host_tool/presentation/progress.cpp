// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "firmware/formats/terminal_line.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kBarWidth = 32;
constexpr std::chrono::milliseconds kQuiet{1000};  // shorter work draws nothing
constexpr std::chrono::milliseconds kRedraw{100};

}  // namespace

Progress::Progress(std::string what, std::size_t total, Clock::time_point (*now)())
    : what_(std::move(what)), total_(total), now_(now), on_terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() { TerminalLine::of_this_process().clear(); }

void Progress::update(std::size_t done) {
  if (!on_terminal_) return;
  const auto now = now_();
  if (now - started_ < kQuiet || now - last_drawn_ < kRedraw) return;
  last_drawn_ = now;
  TerminalLine& line = TerminalLine::of_this_process();
  if (total_ == 0) return line.show(fmt::format("{}  {}", what_, done));
  const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total_));
  const auto filled = static_cast<std::size_t>(share * kBarWidth);
  std::string bar;
  for (std::size_t k = 0; k < kBarWidth; ++k) bar += k < filled ? "█" : "░";
  const double elapsed_s = std::chrono::duration<double>(now - started_).count();
  line.show(fmt::format("{}  {}  {:3.0f} %  {:.0f} s left", what_, bar, 100 * share,
                        share > 0 ? elapsed_s / share - elapsed_s : 0.0));
}

}  // namespace armsig::tool
