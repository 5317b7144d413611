// SPDX-License-Identifier: MIT
// A progress bar in the terminal's line (formats/terminal_line.hpp) for work that takes longer than
// a second; nothing where standard error is no terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace armsig::tool {

class Progress {
 public:
  using Clock = std::chrono::steady_clock;

  // `total` steps are expected; 0 when unknown.
  Progress(std::string what, std::size_t total, Clock::time_point (*now)() = Clock::now);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `done` steps are finished, out of total.
  void update(std::size_t done);

 private:
  std::string what_;
  std::size_t total_;
  Clock::time_point (*now_)();
  bool on_terminal_;
  Clock::time_point started_ = now_();
  Clock::time_point last_drawn_ = started_;
};

}  // namespace armsig::tool
