// SPDX-License-Identifier: MIT
// The lines of a text file of other software.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/formats/problem.hpp"

namespace armsig::tool {

struct TableLine {
  std::size_t number = 0;  // of the file, from 1
  std::string_view text;
  bool is_comment = false;
};

class ForeignTable {
 public:
  // What a file may have at most.
  struct Bounds {
    std::size_t bytes = std::numeric_limits<std::size_t>::max();
    std::size_t rows = std::numeric_limits<std::size_t>::max();
  };

  // Reads UTF-8 or UTF-16. Blank lines are left out; //, # and ! begin comments. Refuses a file
  // without any row, one beyond `bounds`, and a line of more than 64 KiB.
  [[nodiscard]] static Read<ForeignTable> open(const std::string& path, Bounds bounds);

  [[nodiscard]] const std::string& file() const { return file_; }
  // Of lines, comments among them.
  [[nodiscard]] std::size_t size() const { return lines_.size(); }
  [[nodiscard]] TableLine line(std::size_t k) const;
  // Of the first line from `k` on that is no comment; size() where there is none.
  [[nodiscard]] std::size_t row_from(std::size_t k) const;

  // Refuses a byte that is no printable text of UTF-8.
  [[nodiscard]] Read<void> check_text() const;

  // A problem with line `k`, or the whole file.
  [[nodiscard]] std::unexpected<Problem> at(std::size_t k, std::string what,
                                            std::string expected) const;
  [[nodiscard]] std::unexpected<Problem> problem(std::string what, std::string expected) const;

 private:
  struct Place {
    std::size_t number = 0;
    std::size_t start = 0;  // in text_
    std::size_t length = 0;
    bool is_comment = false;
  };

  std::string file_;
  std::string text_;
  std::vector<Place> lines_;
};

}  // namespace armsig::tool
