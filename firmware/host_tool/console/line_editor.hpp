// SPDX-License-Identifier: MIT
// One line of input on a terminal without its own echo: editing keys and the session's history.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace armsig::tool {

class LineEditor {
 public:
  static constexpr std::size_t kMostLines = 200;    // of history
  static constexpr std::size_t kLongestLine = 511;  // what a console takes

  // Takes one byte as the terminal sends it. Return gives the line. Known keys: arrows, Home, End,
  // Backspace, Delete, and Ctrl-A, -E, -K, -U, -W, -C (gives the line up).
  [[nodiscard]] std::optional<std::string> key(char byte);

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] std::size_t cursor() const { return cursor_; }

 private:
  void control(char byte);
  void escape(char byte);
  void recall(std::size_t at);
  void set_text(std::string text);

  std::string text_;
  std::size_t cursor_ = 0;
  std::vector<std::string> history_;
  std::size_t recalled_ = 0;  // index into history_; its size: the line being written
  std::string unfinished_;    // what was written before the first step into the history
  std::string sequence_;      // of an escape sequence, begun with ESC
};

}  // namespace armsig::tool
