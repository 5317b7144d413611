// SPDX-License-Identifier: MIT
// Names in a column, and a text beside each: lines for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace armsig::tool {

class Entries {
 public:
  // Lines of at most `width` characters, 40 at least.
  explicit Entries(std::size_t width);

  // `text` in lines that fit; nothing where it is empty. An empty name goes on with the one before.
  void add(std::string_view name, std::string_view text);
  // The same of text that is one line already.
  void add_line(std::string_view name, std::string_view text);

  // Characters of a line of text.
  [[nodiscard]] std::size_t text_width() const { return text_width_; }
  [[nodiscard]] const std::string& lines() const { return lines_; }

 private:
  std::size_t text_width_;
  std::string lines_;
};

}  // namespace armsig::tool
