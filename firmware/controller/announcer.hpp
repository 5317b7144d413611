// SPDX-License-Identifier: MIT
// Unsolicited lines to every console.
#pragma once

#include <span>

#include "firmware/controller/text.hpp"
#include "hal/console.hpp"

namespace armsig::controller {

inline constexpr std::size_t kMaxConsoles = 4;

class Announcer {
 public:
  explicit Announcer(std::span<hal::Console* const> consoles) {
    for (hal::Console* console : consoles) consoles_.push_back(console);
  }
  void say(const Line& line) const {
    for (hal::Console* console : consoles_) console->broadcast(line.view());
  }
  [[nodiscard]] std::size_t count() const { return consoles_.size(); }
  [[nodiscard]] hal::Console& console(std::size_t i) const { return *consoles_[i]; }

 private:
  FixedVector<hal::Console*, kMaxConsoles> consoles_;
};

}  // namespace armsig::controller
