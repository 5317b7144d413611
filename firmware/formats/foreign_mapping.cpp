// SPDX-License-Identifier: MIT
#include "firmware/formats/foreign_mapping.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/header_reader.hpp"
#include "firmware/formats/headerless.hpp"
#include "firmware/formats/table_cells.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

constexpr std::array kSeparators{';', '\t', ',', kBlanks};

// By what the table is to hold.
std::unexpected<Problem> no_header_of_kind(const ForeignTable& table, const TableNeed& need,
                                           const std::string& doubt) {
  const std::size_t first = table.row_from(0);
  if (need.kind == TableKind::kPoints) {
    return table.at(first, "no header with x, y, z and their unit" + doubt,
                    fmt::format("such as X [mm], or X and --units mm; or {} with places, "
                                "x_mm=@2,y_mm=@3,z_mm=@4",
                                need.wanted.option));
  }
  if (need.kind == TableKind::kJointLog) {
    return table.at(first,
                    fmt::format("no header with the readings of {} joints and their units{}",
                                need.joints.types.size(), doubt),
                    fmt::format("such as A1 [deg] or q1_deg, or A1 and --units deg,mm; or {} with "
                                "a pair for each column, q1_deg=THEIR NAME or q1_deg=@2",
                                need.wanted.option));
  }
  if (need.kind == TableKind::kTaught) {
    return table.problem(
        fmt::format("no line of it names a frame, a point and the readings of {} joints with "
                    "their units{}",
                    need.joints.types.size(), doubt),
        fmt::format("a header such as Frame;Point;A1 [deg];..., or {} with a pair for each "
                    "column, frame=THEIR NAME or frame=@1",
                    need.wanted.option));
  }
  return table.problem(
      "no line of it names joint readings and a position with their units" + doubt,
      fmt::format("a header such as Sweep;Point;A1 [deg];...;X [mm];Y [mm];Z [mm], or {} with a "
                  "pair for each column, x_mm=THEIR NAME or x_mm=@7; the file begins with {}",
                  need.wanted.option, in_quotes(table.line(first).text)));
}

// What is told of a table without a header.
std::unexpected<Problem> no_header(const ForeignTable& table, const TableNeed& need,
                                   const HeaderCandidate& best) {
  const std::size_t first = table.row_from(0);
  // Of a line that names little of what is needed the units are no matter.
  const bool is_near = 2 * best.named >= needed_quantities(need, {}).size();
  const std::string doubt = best.doubt.empty() || !is_near ? "" : ": " + best.doubt;
  std::vector<std::string> names;
  for (const MappedColumn& entry : need.wanted.entries) {
    if (!is_constant(entry.theirs)) names.push_back(entry.theirs);
  }
  if (!names.empty()) {
    return table.problem(
        "no line of it has the columns " + all_of(names) + doubt,
        "names of one line of the file, which begins with " + in_quotes(table.line(first).text));
  }
  return no_header_of_kind(table, need, doubt);
}

// Whether places say all that has to be known.
bool needs_no_header(const TableNeed& need) {
  const std::vector<MappedColumn>& entries = need.wanted.entries;
  const bool all_places = std::ranges::all_of(entries, [](const MappedColumn& entry) {
    return is_constant(entry.theirs) || is_place(entry.theirs);
  });
  if (!need.wanted.automatic || !all_places) return all_places && !entries.empty();
  return std::ranges::all_of(needed_quantities(need, entries), [&](const std::string& quantity) {
    return std::ranges::any_of(
        entries, [&](const MappedColumn& entry) { return quantity_of(entry.ours) == quantity; });
  });
}

// By places alone: the rows begin with the first in which every column that is a number has one.
std::optional<TableLayout> by_places(const ForeignTable& table, const TableNeed& need) {
  for (std::size_t k = 0; k < std::min(table.size(), kLongestPreamble); ++k) {
    if (table.line(k).is_comment) continue;
    for (const char separator : kSeparators) {
      const auto cells = split_line(table.line(k).text, separator);
      if (!cells) continue;
      const auto fits = [&](const MappedColumn& entry) {
        const auto place = place_of(entry.theirs);
        if (!place) return is_constant(entry.theirs);
        if (*place >= cells->size()) return false;
        return is_text_column(entry.ours) || is_number((*cells)[*place], separator);
      };
      if (!std::ranges::all_of(need.wanted.entries, fits)) continue;
      TableLayout layout;
      layout.first_row = k;
      layout.separator = separator;
      layout.width = cells->size();
      for (MappedColumn entry : need.wanted.entries) {
        entry.place = place_of(entry.theirs);
        layout.columns.push_back(std::move(entry));
      }
      for (std::size_t place = 0; place < cells->size(); ++place) {
        if (!is_mapped(layout, place))
          layout.ignored.push_back(fmt::format("column {}", place + 1));
      }
      return layout;
    }
  }
  return std::nullopt;
}

// What a table that has neither is: poses in which any joint may have moved, of one reflector.
void add_constants(const TableNeed& need, TableLayout& layout) {
  if (need.kind != TableKind::kMeasurements || !need.wanted.automatic) return;
  if (layout.find("sweep") == nullptr) layout.columns.push_back({"sweep", "#0"});
  if (layout.find("target") == nullptr) layout.columns.push_back({"target", "#1"});
}

}  // namespace

Read<Wanted> wanted_of(std::string_view option, std::string_view mapping) {
  Wanted wanted{.option = std::string(option), .automatic = false, .entries = {}};
  for (Cells cells(mapping, ','); cells.next();) {
    const std::string_view entry = cells.text();
    const std::size_t equals = entry.find('=');
    const bool is_pair =
        equals != std::string_view::npos && equals > 0 && equals + 1 < entry.size();
    const std::string theirs(is_pair ? trimmed(entry.substr(equals + 1)) : "");
    if (entry == "auto") {
      wanted.automatic = true;
    } else if (is_pair && cells.well_quoted() && (!is_place(theirs) || place_of(theirs))) {
      wanted.entries.push_back({std::string(trimmed(entry.substr(0, equals))), theirs});
    } else {
      return std::unexpected(Problem{std::string(option), 0, 0, in_quotes(entry) + " is no mapping",
                                     "auto, x_mm=THEIR NAME, x_mm=@7 for the seventh column, or "
                                     "target=#1 for every row"});
    }
  }
  return wanted;
}

const MappedColumn* TableLayout::find(std::string_view quantity) const {
  const auto found = std::ranges::find_if(
      columns, [&](const MappedColumn& column) { return quantity_of(column.ours) == quantity; });
  return found == columns.end() ? nullptr : &*found;
}

Read<TableLayout> layout_of(const ForeignTable& table, const TableNeed& need) {
  HeaderCandidate best;
  for (std::size_t k = 0; k < std::min(table.size(), kLongestPreamble); ++k) {
    for (const char separator : kSeparators) {
      auto candidate = read_header(table, need, k, separator);
      if (!candidate) continue;
      if (candidate->complete) {
        if (candidate->fault) return std::unexpected(*std::move(candidate->fault));
        add_constants(need, candidate->layout);
        return std::move(candidate->layout);
      }
      if (candidate->named > best.named) best = *std::move(candidate);
    }
  }
  if (needs_no_header(need)) {
    if (auto layout = by_places(table, need)) {
      add_constants(need, *layout);
      return *std::move(layout);
    }
  }
  if (need.kind == TableKind::kPoints && need.wanted.automatic && best.doubt.empty()) {
    ARMSIG_TRY(layout, headerless_points(table, need.units));
    if (layout) return *std::move(layout);
  }
  return no_header(table, need, best);
}

Read<std::vector<std::string>> row_cells(const ForeignTable& table, const TableLayout& layout,
                                         std::size_t k) {
  std::vector<std::string> texts;
  std::size_t filled = 0;  // up to the last that is not empty
  Cells cells(table.line(k).text, layout.separator);
  while (cells.next()) {
    texts.emplace_back(cells.text());
    if (!cells.text().empty()) filled = texts.size();
  }
  if (!cells.well_quoted()) {
    return table.at(k, "a quote that is not closed, or text behind one", "\"text\"");
  }
  const auto counted = [&](std::size_t count, const char* expected) {
    return table.at(
        k,
        fmt::format("the row has {} columns, {} {}", count,
                    layout.header_line > 0 ? "its header" : "the first row", layout.width),
        expected);
  };
  if (filled > layout.width) {
    return counted(filled, layout.separator == ','
                               ? "decimal points where commas separate the columns; or columns "
                                 "separated by semicolons or tabs"
                               : "as many in every row");
  }
  // Between blanks an empty cell can't be told from none.
  if (layout.separator == kBlanks && filled < layout.width) {
    return counted(filled,
                   "as many in every row; semicolons or tabs between them where some are empty");
  }
  for (const MappedColumn& column : layout.columns) {
    if (!column.place || *column.place < texts.size()) continue;
    return table.at(k, "the row ends before " + in_quotes(column.theirs), "a cell for each column");
  }
  texts.resize(layout.width);
  return texts;
}

std::string words_of_unused(const TableLayout& layout) {
  return layout.ignored.empty() ? "" : "not used: " + all_of(layout.ignored);
}

}  // namespace armsig::tool
