// SPDX-License-Identifier: MIT
#include "firmware/formats/header_reader.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "firmware/formats/headerless.hpp"
#include "firmware/formats/table_cells.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

bool is_range(std::string_view quantity) {
  return quantity.size() > 1 && quantity[0] == 'r' && quantity[1] >= '1' && quantity[1] <= '9';
}

// Whether something is made of columns of a meaning in such a table.
bool is_used(const ColumnMeaning& meaning, TableKind kind) {
  const bool joint = meaning.quantity.starts_with('q');
  const bool position = meaning.dimension != Dimension::kText && !joint &&
                        meaning.quantity != "sweep" && meaning.quantity != "target";
  const bool frame = meaning.quantity == "frame";
  switch (kind) {
    case TableKind::kMeasurements:
      return !meaning.is_text();
    case TableKind::kJointLog:
      return joint || (meaning.is_text() && !frame) || meaning.quantity == "target";
    case TableKind::kPoints:
      return position || (meaning.is_text() && !frame) || meaning.quantity == "target";
    case TableKind::kTaught:
      return joint || frame || meaning.quantity == "point";
  }
  return false;
}

class HeaderReader {
 public:
  HeaderReader(const ForeignTable& table, const TableNeed& need) : table_(table), need_(need) {}

  // Line `k` as the header; nothing where it can't be one.
  std::optional<HeaderCandidate> read(std::size_t k, char separator) {
    auto cells = split_line(without_comment_mark(table_.line(k)), separator);
    if (!cells) return std::nullopt;
    if (separator == kBlanks) join_units(*cells);
    candidate_ = {};
    line_ = k;
    std::size_t after = k + 1;
    add_units(after, separator, *cells);
    candidate_.cells = std::move(*cells);
    TableLayout& layout = candidate_.layout;
    layout.header_line = table_.line(k).number;
    layout.first_row = table_.row_from(after);
    layout.separator = separator;
    layout.width = candidate_.cells.size();
    if (table_.line(k).is_comment && !is_as_wide_as_rows()) return std::nullopt;
    if (!place_entries()) return std::nullopt;
    if (need_.wanted.automatic) map_automatically();
    finish();
    return std::move(candidate_);
  }

 private:
  static std::string_view without_comment_mark(const TableLine& line) {
    std::string_view text = line.text;
    if (!line.is_comment) return text;
    text = trimmed(text);
    return trimmed(text.substr(std::min(text.find_first_not_of("/#!"), text.size())));
  }

  // Between blanks "X", "[mm]" is one name.
  static void join_units(std::vector<std::string>& cells) {
    for (std::size_t k = 1; k < cells.size();) {
      if (!cells[k].starts_with('[') && !cells[k].starts_with('(')) {
        ++k;
        continue;
      }
      cells[k - 1] += " " + cells[k];
      cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(k));
    }
  }

  // A line of nothing but units, below the names.
  void add_units(std::size_t& after, char separator, std::vector<std::string>& cells) const {
    if (after >= table_.size()) return;
    const auto units = split_line(without_comment_mark(table_.line(after)), separator);
    if (!units || units->size() > cells.size()) return;
    const auto is_good = [](const std::string& cell) { return cell.empty() || is_unit(cell); };
    const auto is_empty = [](const std::string& cell) { return cell.empty(); };
    if (!std::ranges::all_of(*units, is_good) || std::ranges::all_of(*units, is_empty)) return;
    for (std::size_t k = 0; k < units->size(); ++k) {
      if (!(*units)[k].empty()) cells[k] += " " + (*units)[k];
    }
    ++after;
  }

  [[nodiscard]] bool is_as_wide_as_rows() const {
    const TableLayout& layout = candidate_.layout;
    if (layout.first_row >= table_.size()) return false;
    const auto row = split_line(table_.line(layout.first_row).text, layout.separator);
    return row && row->size() == layout.width;
  }

  [[nodiscard]] Problem problem(std::string what, std::string expected) const {
    return table_.at(line_, std::move(what), std::move(expected)).error();
  }

  // As --columns would have it.
  [[nodiscard]] std::string choice(const std::string& ours, std::size_t place) const {
    const std::string& name = candidate_.cells[place];
    const bool is_plain = std::ranges::count(candidate_.cells, name) == 1 &&
                          name.find_first_of(",=@#\"'") == std::string::npos;
    return fmt::format("{}={}", ours, is_plain ? name : fmt::format("@{}", place + 1));
  }

  // The first that is found is told.
  void note_fault(Problem fault) {
    if (!candidate_.fault) candidate_.fault = std::move(fault);
  }

  // A header has names where its places are of numbers, and the row below has numbers.
  [[nodiscard]] bool fits_places() const {
    const TableLayout& layout = candidate_.layout;
    std::optional<std::vector<std::string>> row;
    for (const MappedColumn& entry : layout.columns) {
      if (!is_place(entry.theirs) || is_text_column(entry.ours)) continue;
      if (is_number(candidate_.cells[*entry.place], layout.separator)) return false;
      if (layout.first_row >= table_.size()) return false;
      if (!row) row = split_line(table_.line(layout.first_row).text, layout.separator);
      if (!row || *entry.place >= row->size()) return false;
      if (!is_number((*row)[*entry.place], layout.separator)) return false;
    }
    return true;
  }

  bool place_entries() {
    for (MappedColumn entry : need_.wanted.entries) {
      if (const auto place = place_of(entry.theirs)) {
        if (*place >= candidate_.cells.size()) return false;
        entry.place = place;
      } else if (!is_constant(entry.theirs)) {
        const auto found = std::ranges::find(candidate_.cells, entry.theirs);
        if (found == candidate_.cells.end()) return false;
        entry.place = static_cast<std::size_t>(found - candidate_.cells.begin());
        if (std::ranges::count(candidate_.cells, entry.theirs) > 1) {
          note_fault(problem(
              fmt::format("more than one column is called {}", in_quotes(entry.theirs)),
              fmt::format("one by its place, such as {}=@{}", entry.ours, *entry.place + 1)));
        }
      }
      if (entry.place) check_unit(entry);
      candidate_.layout.columns.push_back(std::move(entry));
    }
    return fits_places();
  }

  // A stated unit that contradicts the mapping asked for.
  void check_unit(const MappedColumn& entry) {
    const auto stated = meaning_of(candidate_.cells[*entry.place], need_.joints);
    if (!stated || stated->unit.empty() || stated->ours() == entry.ours) return;
    if (stated->quantity != quantity_of(entry.ours) || !stated->has_good_unit()) return;
    note_fault(problem(
        fmt::format("{} is to come from {}", entry.ours, in_quotes(candidate_.cells[*entry.place])),
        stated->ours()));
  }

  void map_automatically() {
    const std::vector<std::string>& cells = candidate_.cells;
    std::size_t first_joint = 1;
    for (const std::string& cell : cells) {
      const auto meaning = meaning_of(cell, need_.joints);
      if (meaning && meaning->joint_number == std::size_t{0}) first_joint = 0;
    }
    const std::size_t entries = candidate_.layout.columns.size();
    for (std::size_t k = 0; k < cells.size(); ++k) {
      if (is_mapped(candidate_.layout, k)) continue;
      auto meaning = meaning_of(cells[k], need_.joints, first_joint);
      if (meaning && need_.kind == TableKind::kMeasurements && meaning->quantity == "name" &&
          meaning->rank == kRankOfPoint) {
        // What a reflector is called where a row is a measurement.
        meaning = ColumnMeaning{
            .quantity = "target", .unit = {}, .dimension = Dimension::kInteger, .rank = 1};
      }
      if (meaning && need_.kind == TableKind::kTaught && meaning->quantity == "name" &&
          meaning->rank == kRankOfPoint) {
        meaning = ColumnMeaning{.quantity = "point", .unit = {}, .dimension = Dimension::kText};
      }
      if (meaning && is_used(*meaning, need_.kind)) take(*std::move(meaning), k, entries);
    }
  }

  void take(ColumnMeaning meaning, std::size_t place, std::size_t entries) {
    std::vector<MappedColumn>& columns = candidate_.layout.columns;
    const auto same = std::ranges::find_if(columns, [&](const MappedColumn& column) {
      return quantity_of(column.ours) == meaning.quantity;
    });
    if (same < columns.begin() + static_cast<std::ptrdiff_t>(entries)) return;
    if (is_outside(meaning)) {
      note_fault(problem(
          fmt::format("column {} is for a joint outside the arm, which has {}",
                      in_quotes(candidate_.cells[place]), need_.joints.types.size()),
          fmt::format("that many joints; or {} with a pair for each column", need_.wanted.option)));
      return;
    }
    add_stated_unit(meaning);
    if (!meaning.has_good_unit()) {
      ++candidate_.named;
      note_unit(meaning, place);
      return;
    }
    if (same == columns.end()) {
      columns.push_back({meaning.ours(), candidate_.cells[place], place});
      ranks_.resize(columns.size());
      ranks_[columns.size() - 1] = meaning.rank;
      return;
    }
    std::size_t& rank = ranks_[static_cast<std::size_t>(same - columns.begin())];
    if (meaning.rank > rank) return;
    if (meaning.rank == rank) {
      note_fault(two_columns(*same, meaning, place));
      return;
    }
    rank = meaning.rank;
    *same = {meaning.ours(), candidate_.cells[place], place};
  }

  // Commanded and actual readings, say: which is meant nobody can guess.
  [[nodiscard]] Problem two_columns(const MappedColumn& taken, const ColumnMeaning& other,
                                    std::size_t place) const {
    return problem(fmt::format("{} may come from {} or from {}", quantity_of(taken.ours),
                               in_quotes(taken.theirs), in_quotes(candidate_.cells[place])),
                   fmt::format("{} auto,{}, or {}", need_.wanted.option,
                               choice(taken.ours, *taken.place), choice(other.ours(), place)));
  }

  [[nodiscard]] bool is_outside(const ColumnMeaning& meaning) const {
    if (!meaning.joint_number) return false;
    const auto joint = parse_integer(std::string_view(meaning.quantity).substr(1)).value_or(0);
    return joint < 1 || static_cast<std::size_t>(joint) > need_.joints.types.size();
  }

  void add_stated_unit(ColumnMeaning& meaning) const {
    if (!meaning.unit.empty()) return;
    if (meaning.dimension == Dimension::kAngle) meaning.unit = need_.units.angle;
    if (meaning.dimension == Dimension::kLength) meaning.unit = need_.units.length;
  }

  void note_unit(const ColumnMeaning& meaning, std::size_t place) {
    if (!candidate_.doubt.empty()) return;
    const std::string name = in_quotes(candidate_.cells[place]);
    candidate_.doubt = meaning.unit.empty()
                           ? fmt::format("column {} has no unit", name)
                           : fmt::format("column {} has another unit than {}", name,
                                         any_of(names_of(meaning.quantity, meaning.dimension)));
  }

  void finish() {
    TableLayout& layout = candidate_.layout;
    bool all = true;
    for (const std::string& quantity : needed_quantities(need_, layout.columns)) {
      const bool found = layout.find(quantity) != nullptr;
      candidate_.named += found ? 1 : 0;
      all = all && found;
    }
    const auto is_named = [](const MappedColumn& entry) {
      return !is_constant(entry.theirs) && !is_place(entry.theirs);
    };
    candidate_.complete =
        need_.wanted.automatic ? all : std::ranges::any_of(need_.wanted.entries, is_named);
    for (std::size_t k = 0; k < candidate_.cells.size(); ++k) {
      if (is_mapped(layout, k)) continue;
      layout.ignored.push_back(candidate_.cells[k].empty() ? fmt::format("column {}", k + 1)
                                                           : candidate_.cells[k]);
    }
  }

  const ForeignTable& table_;
  const TableNeed& need_;
  HeaderCandidate candidate_;
  std::vector<std::size_t> ranks_;  // of the columns
  std::size_t line_ = 0;
};

}  // namespace

bool is_constant(std::string_view theirs) { return theirs.starts_with('#'); }
bool is_place(std::string_view theirs) { return theirs.starts_with('@'); }

std::optional<std::size_t> place_of(std::string_view theirs) {
  if (!is_place(theirs)) return std::nullopt;
  theirs.remove_prefix(1);
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(theirs.data(), theirs.data() + theirs.size(), number);
  if (error != std::errc{} || end != theirs.data() + theirs.size() || number == 0) {
    return std::nullopt;
  }
  return number - 1;
}

bool is_mapped(const TableLayout& layout, std::size_t place) {
  return std::ranges::find(layout.columns, std::optional(place), &MappedColumn::place) !=
         layout.columns.end();
}

std::vector<std::string> needed_quantities(const TableNeed& need,
                                           const std::vector<MappedColumn>& columns) {
  std::vector<std::string> names;
  if (need.kind != TableKind::kPoints) {
    for (std::size_t j = 1; j <= need.joints.types.size(); ++j) {
      names.push_back(fmt::format("q{}", j));
    }
  }
  const bool by_ranges = std::ranges::any_of(
      columns, [](const MappedColumn& column) { return is_range(quantity_of(column.ours)); });
  if (need.kind == TableKind::kTaught) {
    names.insert(names.end(), {"frame", "point"});
  } else if (need.kind != TableKind::kJointLog && !by_ranges) {
    names.insert(names.end(), {"x", "y", "z"});
  }
  return names;
}

std::optional<HeaderCandidate> read_header(const ForeignTable& table, const TableNeed& need,
                                           std::size_t k, char separator) {
  return HeaderReader(table, need).read(k, separator);
}

}  // namespace armsig::tool
