// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/table.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/base/check.hpp"

namespace armsig::tool {
namespace {

// Characters, not bytes: the texts are UTF-8.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

}  // namespace

Table::Table(std::vector<std::string> headings) { rows_.push_back(std::move(headings)); }

void Table::add_row(std::vector<std::string> cells) {
  ARMSIG_CHECK(cells.size() == rows_.front().size());
  rows_.push_back(std::move(cells));
}

std::string Table::render(int indent) const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width(row[c]));
  }
  const std::string margin(static_cast<std::size_t>(indent), ' ');
  std::string text;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    std::string line = margin;
    for (std::size_t c = 0; c < widths.size(); ++c) {
      const std::string pad(widths[c] - width(rows_[r][c]), ' ');
      if (c > 0) line += "   ";
      line += c == 0 ? rows_[r][c] + pad : pad + rows_[r][c];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
    if (r == 0) {
      text += margin;
      for (std::size_t c = 0; c < widths.size(); ++c) {
        if (c > 0) text += "   ";
        for (std::size_t k = 0; k < widths[c]; ++k) text += "─";
      }
      text += '\n';
    }
  }
  return text;
}

}  // namespace armsig::tool
