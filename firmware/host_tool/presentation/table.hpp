// SPDX-License-Identifier: MIT
// A table of text for a terminal: columns aligned, numbers to the right, a rule under the heading.
#pragma once

#include <string>
#include <vector>

namespace armsig::tool {

class Table {
 public:
  // Headings; the first column is aligned to the left, the others to the right.
  explicit Table(std::vector<std::string> headings);
  // Precondition: as many cells as headings.
  void add_row(std::vector<std::string> cells);
  // Every line ends with a newline and begins with `indent` spaces.
  [[nodiscard]] std::string render(int indent = 2) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace armsig::tool
