// SPDX-License-Identifier: MIT
// A person's terminal: lines that are edited, completed by Tab, and kept from one time to the next,
// while something else may be said above them. By libedit; its keys are those of its emacs mode,
// and Ctrl-C gives up the line.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace armsig::tool {

class Terminal {
 public:
  // What the last word of the text before the cursor may become.
  using Complete = std::function<std::vector<std::string>(std::string_view before)>;
  // What is to be said above the line that is typed, whole printable lines, where `descriptor` is
  // readable; nothing where the talk has ended.
  using Hear = std::function<std::optional<std::string>()>;

  // `prompt` is ASCII. The history is read from `history_file` and written there at the end; empty:
  // it is not kept.
  Terminal(std::string prompt, int descriptor, Complete complete, Hear hear,
           std::string history_file);
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // The next line, without its end; nothing where the person or the other side has left.
  [[nodiscard]] std::optional<std::string> read_line();

  // Between two lines. `text`: whole lines, printable.
  static void print(std::string_view text);

 private:
  class Library;
  std::unique_ptr<Library> library_;
};

// Where the history of consoles is kept: $XDG_STATE_HOME/armsig/console, or below
// ~/.local/state; empty where there is no home. Makes the folder.
[[nodiscard]] std::string console_history_file();

}  // namespace armsig::tool
