// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include <fmt/core.h>

namespace armsig::tool {
namespace {

constexpr std::size_t kBarWidth = 32;
constexpr std::chrono::milliseconds kQuiet{1000};  // shorter work draws nothing
constexpr std::chrono::milliseconds kRedraw{100};

}  // namespace

Progress::Progress(std::string what, std::size_t total)
    : what_(std::move(what)), total_(total), on_terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

void Progress::update(std::size_t done) {
  if (!on_terminal_) return;
  const auto now = Clock::now();
  if (now - started_ < kQuiet || now - last_drawn_ < kRedraw) return;
  last_drawn_ = now;
  drawn_ = true;
  if (total_ == 0) {
    fmt::print(stderr, "\r\033[K{}  {}", what_, done);
    return;
  }
  const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total_));
  const auto filled = static_cast<std::size_t>(share * kBarWidth);
  std::string bar;
  for (std::size_t k = 0; k < kBarWidth; ++k) bar += k < filled ? "█" : "░";
  const double elapsed_s = std::chrono::duration<double>(now - started_).count();
  fmt::print(stderr, "\r\033[K{}  {}  {:3.0f} %  {:.0f} s left", what_, bar, 100 * share,
             share > 0 ? elapsed_s / share - elapsed_s : 0.0);
}

}  // namespace armsig::tool
