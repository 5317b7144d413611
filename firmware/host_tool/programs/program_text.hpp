// SPDX-License-Identifier: MIT
// What the readers of robot programs have in common: lines, words and numbers by their bytes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/host_tool/programs/program.hpp"

namespace armsig::tool {

// Where comments and strings begin and end in a language.
struct Comments {
  char to_end_of_line = ';';
  bool double_quotes = true;
  bool parentheses = false;
};

// The text with its comments and strings blanked: as long, with the same lines.
[[nodiscard]] std::string without_comments(std::string_view text, const Comments& comments);

// In capitals, of the same length: languages without small and capital letters.
[[nodiscard]] std::string in_capitals(std::string_view text);

[[nodiscard]] bool is_word(char c);

class ProgramScanner {
 public:
  explicit ProgramScanner(std::string_view text, std::size_t at = 0) : text_(text), at_(at) {}

  [[nodiscard]] std::size_t at() const { return at_; }
  void go_to(std::size_t at) { at_ = at; }
  [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }
  [[nodiscard]] char peek() const { return at_end() ? '\0' : text_[at_]; }

  void skip_blanks();
  // Past `c` where it comes next.
  bool accept(char c);
  // The word that comes next: letters, digits, _ and $; empty where there is none.
  std::string_view word();
  // Numbers between `open` and `close`, commas between them; nothing, with the place as it was,
  // where something else is.
  std::optional<std::vector<Bytes>> list(char open, char close);
  // A number in decimal digits: its bytes; nothing, with the place as it was, of anything else.
  std::optional<Bytes> number();
  // To the next word that begins after here; false at the end of the text.
  bool next_word();

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

// Of the line of a place, from 1. Asked for places in any order.
class LineNumbers {
 public:
  explicit LineNumbers(std::string_view text);
  [[nodiscard]] int line_of(std::size_t at) const;

 private:
  std::vector<std::size_t> ends_;
};

// The values of numbers at `places`. Precondition: they are numbers.
[[nodiscard]] std::vector<double> values_at(std::string_view text,
                                            const std::vector<Bytes>& places);

// The arguments between a parenthesis and its counterpart, or up to `end`, at commas outside of any
// bracket. `at`: behind the opening parenthesis.
[[nodiscard]] std::vector<Bytes> arguments_from(std::string_view text, std::size_t at, char end);

// The bytes without blanks at their ends.
[[nodiscard]] Bytes trimmed_bytes(std::string_view text, Bytes bytes);

[[nodiscard]] inline std::string_view text_at(std::string_view text, Bytes bytes) {
  return text.substr(bytes.begin, bytes.end - bytes.begin);
}

}  // namespace armsig::tool
