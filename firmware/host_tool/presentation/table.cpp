// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/table.hpp"

#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>

#include "core/base/check.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kGap = 3;

std::size_t longest(const Lines& lines) {
  std::size_t most = 0;
  for (const std::string& line : lines) most = std::max(most, width_of(line));
  return most;
}

// How wide each column is, and how wide it has to be.
struct Layout {
  std::vector<std::size_t> widths;
  std::vector<std::size_t> least;
  std::size_t gap = kGap;

  [[nodiscard]] std::size_t total() const {
    return std::accumulate(widths.begin(), widths.end(), gap * (widths.size() - 1));
  }
};

Layout natural(const std::vector<Lines>& rows) {
  Layout columns{std::vector<std::size_t>(rows.front().size(), 0),
                 std::vector<std::size_t>(rows.front().size(), 0)};
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      const std::string& cell = rows[r][c];
      const bool words = r == 0 || c == 0;
      const std::size_t least = words ? longest(wrapped(cell, 0)) : width_of(cell);
      columns.widths[c] = std::max(columns.widths[c], width_of(cell));
      columns.least[c] = std::max(columns.least[c], least);
    }
  }
  return columns;
}

// Takes one character after the other from the column that has most to give, from `first` on.
void narrow(Layout& columns, std::size_t first, std::size_t width) {
  const auto spare = [&](std::size_t c) { return columns.widths[c] - columns.least[c]; };
  while (columns.total() > width) {
    std::size_t chosen = first;
    for (std::size_t c = first; c < columns.widths.size(); ++c) {
      if (spare(c) > spare(chosen)) chosen = c;
    }
    if (spare(chosen) == 0) return;
    --columns.widths[chosen];
  }
}

void fit(Layout& columns, std::size_t width) {
  if (columns.total() > width) columns.gap = 2;
  if (columns.widths.size() > 1) narrow(columns, 1, width);
  if (columns.total() > width) columns.gap = 1;
  narrow(columns, 0, width);
}

// The lines of one row; a heading stands at the bottom of its cell, all else at the top.
std::string rendered(const Lines& cells, const Layout& columns, const std::string& margin,
                     bool heading) {
  std::vector<Lines> parts;
  std::size_t height = 1;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const bool fits = width_of(cells[c]) <= columns.widths[c];
    parts.push_back(fits ? Lines{cells[c]} : wrapped(cells[c], columns.widths[c]));
    height = std::max(height, parts.back().size());
  }
  std::string text;
  for (std::size_t k = 0; k < height; ++k) {
    std::string line = margin;
    for (std::size_t c = 0; c < parts.size(); ++c) {
      const std::size_t above = heading ? height - parts[c].size() : 0;
      const bool inside = k >= above && k - above < parts[c].size();
      const std::string cell = inside ? parts[c][k - above] : "";
      const std::size_t used = std::min(width_of(cell), columns.widths[c]);
      const std::string pad(columns.widths[c] - used, ' ');
      if (c > 0) line += std::string(columns.gap, ' ');
      line += c == 0 ? cell + pad : pad + cell;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

// "-0.00": nothing is left of it after rounding, so its sign tells nothing.
bool is_nought_below_zero(std::string_view cell) {
  if (!cell.starts_with("-0")) return false;
  const std::size_t end = cell.find_first_not_of("0.", 1);
  return end == std::string_view::npos || cell[end] < '0' || cell[end] > '9';
}

}  // namespace

Table::Table(std::vector<std::string> headings) { rows_.push_back(std::move(headings)); }

void Table::add_row(std::vector<std::string> cells) {
  ARMSIG_CHECK(cells.size() == rows_.front().size());
  for (std::string& cell : cells) {
    if (is_nought_below_zero(cell)) cell.erase(0, 1);
  }
  rows_.push_back(std::move(cells));
}

std::string Table::render(int indent, std::size_t width) const {
  const std::string margin(static_cast<std::size_t>(indent), ' ');
  Layout columns = natural(rows_);
  fit(columns, std::max(width, margin.size()) - margin.size());
  std::string text;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    text += rendered(rows_[r], columns, margin, r == 0);
    if (r > 0) continue;
    text += margin;
    for (std::size_t c = 0; c < columns.widths.size(); ++c) {
      if (c > 0) text += std::string(columns.gap, ' ');
      for (std::size_t k = 0; k < columns.widths[c]; ++k) text += "─";
    }
    text += '\n';
  }
  return text;
}

}  // namespace armsig::tool
