// SPDX-License-Identifier: MIT
// The cells of one line of a table. Every byte of the line is in a cell, a blank around one, a
// quote about one, or a separator.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace armsig::tool {

// As a separator: runs of blanks and tabs, and those at both ends of the line separate nothing.
inline constexpr char kBlanks = ' ';

// Whether a cell may stand in double quotes, with "" for a quote inside (RFC 4180).
enum class Quotes : std::uint8_t { kAreText, kEnclose };

class Cells {
 public:
  Cells(std::string_view line, char separator, Quotes quotes = Quotes::kEnclose);

  // Moves to the next cell; false at the end of the line. A separator at the end is followed by an
  // empty cell.
  [[nodiscard]] bool next();
  // Without the blanks and the quotes around it. Valid until next().
  [[nodiscard]] std::string_view text() const { return text_; }
  [[nodiscard]] std::size_t position() const { return position_; }  // of its first byte, from 0
  // False where a quote is not closed, or something follows the closing one within the cell.
  [[nodiscard]] bool well_quoted() const { return well_quoted_; }

 private:
  [[nodiscard]] bool is_blank(char c) const;
  [[nodiscard]] bool separates(char c) const;
  void skip_blanks();
  void take_quoted();
  void take_plain();

  std::string_view line_;
  char separator_;
  Quotes quotes_;
  std::size_t at_ = 0;
  bool more_ = true;  // a cell follows, be it an empty one
  bool well_quoted_ = true;
  std::size_t position_ = 0;
  std::string_view text_;
  std::string unquoted_;  // of a cell with quotes inside
};

// The cells of a line but empty ones at its end; nothing where a quote is not closed.
[[nodiscard]] std::optional<std::vector<std::string>> split_line(std::string_view line,
                                                                 char separator);

}  // namespace armsig::tool
