// SPDX-License-Identifier: MIT
#include "firmware/formats/foreign_columns.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/table_cells.hpp"
#include "firmware/formats/table_numbers.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

// Programs that write Latin-1 are understood: a header line may have its letters and signs. What is
// a control character in either encoding is refused.
std::optional<std::size_t> first_bad_in_header(std::string_view line, char separator) {
  for (std::size_t at = 0; at < line.size();) {
    const Character character = first_character(line.substr(at));
    const auto byte = static_cast<std::uint8_t>(line[at]);
    const bool good =
        character.length > 0 ? is_printable(character.code) || line[at] == separator : byte >= 0xA0;
    if (!good) return at;
    at += std::max<std::size_t>(character.length, 1);
  }
  return std::nullopt;
}

Read<void> check_header(const ForeignTable& table, const TableLayout& layout) {
  for (std::size_t k = 0; k < layout.first_row; ++k) {
    const TableLine line = table.line(k);
    if (line.number != layout.header_line) continue;
    const auto bad = first_bad_in_header(line.text, layout.separator);
    if (!bad) return {};
    return std::unexpected(Problem{
        table.file(), static_cast<int>(line.number), static_cast<int>(*bad + 1),
        "the byte " + in_quotes(line.text.substr(*bad, 1)) + " in the header", "printable text"});
  }
  return {};
}

// One row in our format.
Read<std::string> row_of_ours(const ForeignTable& table, const TableLayout& layout, std::size_t k,
                              TableNumbers& numbers) {
  ARMSIG_TRY(cells, row_cells(table, layout, k));
  std::string row;
  for (const MappedColumn& column : layout.columns) {
    if (!row.empty() || &column != layout.columns.data()) row += ',';
    if (!column.place) {
      row += column.theirs.substr(1);
      continue;
    }
    const std::string& cell = cells[*column.place];
    if (column.ours == "frame" || column.ours == "point") {
      if (cell.find(',') != std::string::npos) {
        return table.at(k, fmt::format("{}: {} has a comma", column.theirs, in_quotes(cell)),
                        "a name without commas");
      }
      row += cell;
      continue;
    }
    if (column.ours == "target" && !parse_integer(cell)) {
      return table.at(k, fmt::format("{}: {} is no number", column.theirs, in_quotes(cell)),
                      "the number of a reflector; or --columns auto,target=#1 where there is one");
    }
    ARMSIG_TRY(spelt,
               in_file(table.file(), numbers.plain(cell, column.theirs, table.line(k).number)));
    row += spelt;
  }
  return row;
}

std::string_view word_of_separator(char separator) {
  switch (separator) {
    case ';':
      return "semicolons";
    case '\t':
      return "tabs";
    case kBlanks:
      return "blanks";
    default:
      return "commas";
  }
}

Read<MappedTable> map_table(const std::string& path, const TableNeed& need) {
  ARMSIG_TRY(table, ForeignTable::open(path, {}));
  MappedTable mapped;
  ARMSIG_TRY(layout, layout_of(table, need));
  if (auto header = check_header(table, layout); !header) {
    return std::unexpected(std::move(header).error());
  }
  mapped.first_line = layout.header_line > 0 ? 1 : 0;
  std::size_t next = mapped.first_line;
  // Our lines have the numbers of theirs, so that a problem names the right one.
  const auto write = [&](std::string_view line, std::size_t number) {
    for (; next < number; ++next) mapped.text += '\n';
    mapped.text += line;
    mapped.text += '\n';
    ++next;
  };
  std::string names;
  for (const MappedColumn& column : layout.columns) {
    names += (names.empty() ? "" : ",") + column.ours;
  }
  TableNumbers numbers(layout.separator);
  write(names, layout.header_line);
  for (std::size_t k = table.row_from(layout.first_row); k < table.size();
       k = table.row_from(k + 1)) {
    ARMSIG_TRY(row, row_of_ours(table, layout, k, numbers));
    write(row, table.line(k).number);
  }
  if (auto good = in_file(path, numbers.finish()); !good) {
    return std::unexpected(std::move(good).error());
  }
  mapped.layout = std::move(layout);
  mapped.decimal_comma = numbers.decimal_comma();
  return mapped;
}

}  // namespace

Read<MappedTable> map_measurements(const std::string& path, std::string_view mapping,
                                   const NamedJoints& joints, const StatedUnits& units) {
  ARMSIG_TRY(wanted, wanted_of("--columns", mapping));
  return map_table(path, {TableKind::kMeasurements, joints, std::move(wanted), units});
}

Read<MappedTable> map_taught_points(const std::string& path, std::string_view mapping,
                                    const NamedJoints& joints) {
  ARMSIG_TRY(wanted, wanted_of("--columns", mapping));
  return map_table(path, {TableKind::kTaught, joints, std::move(wanted), {}});
}

std::string in_words(const MappedTable& mapped) {
  const TableLayout& layout = mapped.layout;
  std::string words = fmt::format(
      "Columns ({}, {}{})\n\n",
      layout.header_line > 0 ? fmt::format("header in line {}", layout.header_line) : "no header",
      word_of_separator(layout.separator), mapped.decimal_comma ? ", decimal commas" : "");
  for (const MappedColumn& column : layout.columns) {
    words += fmt::format("  {:<10} from  {}\n", column.ours, column.theirs);
  }
  const std::string unused = words_of_unused(layout);
  if (!unused.empty()) words += fmt::format("  {}\n", unused);
  return words + "\n";
}

}  // namespace armsig::tool
