// SPDX-License-Identifier: MIT
#include "firmware/formats/foreign_table.hpp"

#include <utility>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/csv_lines.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

bool begins_a_comment(std::string_view line) {
  return line.starts_with("//") || line.starts_with('#') || line.starts_with('!');
}

}  // namespace

Read<ForeignTable> ForeignTable::open(const std::string& path, Bounds bounds) {
  ARMSIG_TRY(lines, LineReader::open(path));
  ForeignTable table;
  table.file_ = path;
  std::size_t rows = 0;
  for (;;) {
    ARMSIG_TRY(more, lines.next_or_comment());
    if (!more) break;
    const std::string_view line = lines.line();
    const bool is_comment = begins_a_comment(trimmed(line));
    table.lines_.push_back({lines.number(), table.text_.size(), line.size(), is_comment});
    table.text_ += line;
    rows += is_comment ? 0 : 1;
    if (table.text_.size() > bounds.bytes) {
      return table.problem("the file is too large",
                           fmt::format("at most {} KiB", bounds.bytes >> 10U));
    }
    if (rows > bounds.rows) {
      return table.problem(fmt::format("more than {} rows", bounds.rows),
                           fmt::format("at most {}", bounds.rows));
    }
  }
  if (rows == 0) {
    return table.problem(
        table.lines_.empty() ? std::string(lines.what_it_is()) : "the file holds only comments",
        "a header line, then one row a line; //, # and ! begin comments");
  }
  return table;
}

TableLine ForeignTable::line(std::size_t k) const {
  const Place& place = lines_[k];
  return {place.number, std::string_view(text_).substr(place.start, place.length),
          place.is_comment};
}

std::size_t ForeignTable::row_from(std::size_t k) const {
  while (k < lines_.size() && lines_[k].is_comment) ++k;
  return k;
}

Read<void> ForeignTable::check_text() const {
  for (std::size_t k = 0; k < lines_.size(); ++k) {
    const std::string_view text = line(k).text;
    const auto bad = first_bad_byte(text);
    if (!bad) continue;
    const std::string_view rest = text.substr(*bad);
    const Character character = first_character(rest);
    if (character.length > 0) {
      return at(k, "the character " + in_quotes(rest.substr(0, character.length)),
                "printable text");
    }
    return at(k, "a byte that is no text of UTF-8 or UTF-16",
              "UTF-8: save it so, or iconv -f WINDOWS-1252 -t UTF-8");
  }
  return {};
}

std::unexpected<Problem> ForeignTable::at(std::size_t k, std::string what,
                                          std::string expected) const {
  return std::unexpected(
      Problem{file_, static_cast<int>(lines_[k].number), 0, std::move(what), std::move(expected)});
}

std::unexpected<Problem> ForeignTable::problem(std::string what, std::string expected) const {
  return std::unexpected(Problem{file_, 0, 0, std::move(what), std::move(expected)});
}

}  // namespace armsig::tool
