// SPDX-License-Identifier: MIT
// The line of the terminal in which work in progress shows how far it is.
#pragma once

#include <string_view>

namespace armsig::tool {

// One a process, on standard error. Whoever writes a result, on standard output too, clears it
// first; print functions (presentation/say.hpp) and AtomicFile do, so that nobody else has to.
class TerminalLine {
 public:
  [[nodiscard]] static TerminalLine& of_this_process();
  TerminalLine(const TerminalLine&) = delete;
  TerminalLine& operator=(const TerminalLine&) = delete;

  // Puts `text`, printable and without a line feed, in the place of what the line shows. Nothing
  // where standard error is no terminal.
  void show(std::string_view text);

  // Leaves the line empty; nothing where it shows nothing.
  void clear();

 private:
  TerminalLine() = default;

  bool is_shown_ = false;
};

}  // namespace armsig::tool
