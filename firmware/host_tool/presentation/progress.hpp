// SPDX-License-Identifier: MIT
// A progress bar on standard error for work that takes longer than a second; nothing where it is
// not a terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace armsig::tool {

class Progress {
 public:
  // `total` steps are expected; 0 when unknown.
  Progress(std::string what, std::size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `done` steps are finished, out of total.
  void update(std::size_t done);

 private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  std::size_t total_;
  bool on_terminal_;
  bool drawn_ = false;
  Clock::time_point started_ = Clock::now();
  Clock::time_point last_drawn_ = started_;
};

}  // namespace armsig::tool
