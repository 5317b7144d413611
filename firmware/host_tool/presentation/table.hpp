// SPDX-License-Identifier: MIT
// A table of text for a terminal: columns aligned, numbers to the right, a rule under the heading.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware/formats/wrapping.hpp"

namespace armsig::tool {

class Table {
 public:
  // Headings; the first column is aligned to the left, the others to the right.
  explicit Table(std::vector<std::string> headings);
  // Precondition: as many cells as headings.
  void add_row(std::vector<std::string> cells);
  // Every line ends with a newline and begins with `indent` spaces. What is wider than `width`
  // gets narrower gaps, then headings on several lines, then lines of the first column likewise;
  // numbers are never cut, so that a table may remain wider.
  [[nodiscard]] std::string render(int indent = 2, std::size_t width = output_width()) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace armsig::tool
