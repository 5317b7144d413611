// SPDX-License-Identifier: MIT
// The numbers of a table of other software: decimal points in all of them or decimal commas, and no
// thousands separators.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/formats/problem.hpp"

namespace armsig::tool {

class TableNumbers {
 public:
  // `separator`: of the columns. Where it is a comma, no number has a decimal one.
  explicit TableNumbers(char separator) : separator_(separator) {}

  // `text` with a decimal point, as the C locale spells it; what is no number comes back as it is,
  // for the reader of numbers to refuse. Refuses what may have a thousands separator, and another
  // decimal sign than that of the numbers before. Problems have no file.
  [[nodiscard]] Read<std::string> plain(std::string_view text, std::string_view column,
                                        std::size_t line);

  // Refuses, after the last row, a column in which three digits follow every decimal sign and other
  // numbers have none, as 1,234 and 812 do: what looks like a decimal sign separates thousands.
  [[nodiscard]] Read<void> finish() const;

  [[nodiscard]] bool decimal_comma() const { return comma_; }

 private:
  struct Column {
    std::string first;  // number with a decimal sign
    std::size_t line = 0;
    bool has_integers = false;
  };
  void note(std::string_view text, std::string_view column, std::size_t line);

  char separator_;
  bool comma_ = false;  // a number had one
  bool point_ = false;
  bool only_groups_ = true;  // three digits follow each decimal sign
  std::map<std::string, Column, std::less<>> columns_;
};

}  // namespace armsig::tool
