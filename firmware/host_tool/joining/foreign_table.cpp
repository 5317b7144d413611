// SPDX-License-Identifier: MIT
#include "firmware/host_tool/joining/foreign_table.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/encoding.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"

namespace armsig::tool {
namespace {

constexpr char kBlankSeparated = ' ';

// Hours of a controller's log, ten rows a second. A column takes 32 bytes in memory and a row some
// 100 more, however short they are in the file.
constexpr std::size_t kLargestTable = std::size_t{16} << 20U;
constexpr std::size_t kMostRows = 1'000'000;

// What is wrong with the byte at the start of `text`, which is no text of a table.
Problem bad_text(const std::string& path, std::size_t line, std::string_view text) {
  const Character character = first_character(text);
  if (character.length > 0) {
    return {path, static_cast<int>(line), 0,
            "the character " + in_quotes(text.substr(0, character.length)), "printable text"};
  }
  return {path, static_cast<int>(line), 0, "a byte that is no text of UTF-8 or UTF-16",
          "UTF-8: save it so, or iconv -f WINDOWS-1252 -t UTF-8"};
}

bool is_comment(std::string_view line) {
  return line.empty() || line.starts_with("//") || line.front() == '#' || line.front() == '!';
}

// Whether `c` stands in `line` outside of double quotes.
bool has_outside_quotes(std::string_view line, char c) {
  bool quoted = false;
  for (const char at : line) {
    if (at == '"') quoted = !quoted;
    if (at == c && !quoted) return true;
  }
  return false;
}

std::vector<std::string> split(std::string_view line, char separator) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    const bool blank = separator == kBlankSeparated && (c == ' ' || c == '\t');
    if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && (c == separator || blank)) {
      if (!blank || !fields.back().empty()) fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  for (std::string& field : fields) field = std::string(trimmed(field));
  while (!fields.empty() && fields.back().empty()) fields.pop_back();
  fields.shrink_to_fit();
  return fields;
}

std::vector<std::pair<std::size_t, std::string_view>> lines_of(std::string_view text) {
  const char line_end = has_lone_returns(text) ? '\r' : '\n';
  std::vector<std::pair<std::size_t, std::string_view>> lines;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find(line_end), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (!is_comment(trimmed(line))) lines.emplace_back(number, line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

}  // namespace

Read<ForeignTable> read_foreign_table(const std::string& path) {
  ARMSIG_TRY(bytes, read_text_file(path, kLargestTable));
  const auto text = in_utf8(bytes);
  if (!text) {
    return std::unexpected(
        Problem{path, 0, 0, "its UTF-16 breaks off in mid-character", "a whole file"});
  }
  if (const auto bad = first_bad_byte(*text)) {
    const auto before = std::string_view(*text).substr(0, *bad);
    const auto line = 1 + std::ranges::count(before, has_lone_returns(*text) ? '\r' : '\n');
    return std::unexpected(
        bad_text(path, static_cast<std::size_t>(line), std::string_view(*text).substr(*bad)));
  }
  const auto lines = lines_of(*text);
  if (lines.empty()) {
    return std::unexpected(
        Problem{path, 0, 0, trimmed(*text).empty() ? "the file is empty" : "the file holds no rows",
                "a row a line; //, # and ! begin comments"});
  }
  if (lines.size() > kMostRows) {
    return std::unexpected(Problem{path, 0, 0, fmt::format("{} rows", lines.size()),
                                   fmt::format("at most {}", kMostRows)});
  }
  char separator = kBlankSeparated;
  for (const char candidate : {',', '\t', ';'}) {
    if (std::ranges::any_of(
            lines, [&](const auto& line) { return has_outside_quotes(line.second, candidate); })) {
      separator = candidate;
    }
  }
  ForeignTable table{.file = path, .decimal_comma = separator != ',', .rows = {}};
  table.rows.reserve(lines.size());
  for (const auto& [number, line] : lines) table.rows.push_back({number, split(line, separator)});
  return table;
}

std::optional<double> number_in(const ForeignTable& table, const std::string& field) {
  if (!table.decimal_comma || field.find(',') == std::string::npos) return parse_number(field);
  if (field.find('.') != std::string::npos || std::ranges::count(field, ',') > 1)
    return std::nullopt;
  std::string spelt = field;
  std::ranges::replace(spelt, ',', '.');
  return parse_number(spelt);
}

}  // namespace armsig::tool
