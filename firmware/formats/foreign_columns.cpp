// SPDX-License-Identifier: MIT
#include "firmware/formats/foreign_columns.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/csv_lines.hpp"
#include "firmware/formats/foreign_mapping.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

// Software writes its own name, dates and settings before the table; more than this is no header.
constexpr std::size_t kLongestPreamble = 60;

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

std::unexpected<Problem> no_header(const std::string& path, const Wanted& wanted,
                                   const std::string& first_line) {
  std::vector<std::string> names;
  for (const MappedColumn& entry : wanted.entries) {
    if (!entry.theirs.starts_with('#')) names.push_back(entry.theirs);
  }
  const std::string what =
      names.empty() ? "no line of it names joint readings and a position with their units"
                    : "no line of it has the columns " + all_of(names);
  return std::unexpected(Problem{path, 0, 0, what,
                                 "a header such as Sweep;Point;A1 [deg];...;X [mm];Y [mm];Z [mm], "
                                 "or --columns with a pair for "
                                 "each column; the file begins with " +
                                     in_quotes(first_line)});
}

class Mapper {
 public:
  Mapper(std::string path, Wanted wanted, const JointTypes& types)
      : path_(std::move(path)), wanted_(std::move(wanted)), types_(types) {}

  // Takes a line of the file: what stands before the header, the header, or a row.
  [[nodiscard]] Read<void> take(std::string_view line, std::size_t number) {
    if (first_line_.empty()) first_line_ = line;
    return mapped_.header_line == 0 ? look_for_header(line, number) : take_row(line, number);
  }

  [[nodiscard]] bool began() const { return !first_line_.empty(); }

  [[nodiscard]] Read<MappedMeasurements> finish() && {
    if (mapped_.header_line == 0) return no_header(path_, wanted_, first_line_);
    return std::move(mapped_);
  }

 private:
  Read<void> look_for_header(std::string_view line, std::size_t number) {
    if (++preamble_ > kLongestPreamble) return no_header(path_, wanted_, first_line_);
    for (const char separator : {';', '\t', ','}) {
      const auto header = fields_of(line, separator);
      auto found = places_in(header, wanted_, types_, mapped_.columns);
      if (!found) continue;
      if (const auto bad = first_bad_in_header(line, separator)) {
        return std::unexpected(Problem{
            path_, static_cast<int>(number), static_cast<int>(*bad + 1),
            "the byte " + in_quotes(line.substr(*bad, 1)) + " in the header", "printable text"});
      }
      places_ = std::move(*found);
      mapped_.separator = separator;
      mapped_.header_line = number;
      for (std::size_t k = 0; k < header.size(); ++k) {
        if (std::ranges::find(places_, k) == places_.end()) mapped_.ignored.push_back(header[k]);
      }
      if (auto problem = contradiction(path_, mapped_, types_)) return std::unexpected(*problem);
      if (auto problem = ambiguity(path_, mapped_, wanted_, types_)) {
        return std::unexpected(*problem);
      }
      std::vector<std::string> names;
      names.reserve(mapped_.columns.size());
      for (const MappedColumn& column : mapped_.columns) names.push_back(column.ours);
      write(names, number);
      break;
    }
    return {};
  }

  Read<void> take_row(std::string_view line, std::size_t number) {
    const auto fields = fields_of(line, mapped_.separator);
    std::vector<std::string> ours;
    for (std::size_t k = 0; k < places_.size(); ++k) {
      if (!places_[k]) {
        ours.push_back(mapped_.columns[k].theirs.substr(1));
        continue;
      }
      if (*places_[k] >= fields.size()) break;  // the reader of our format says so
      const std::string& field = fields[*places_[k]];
      auto spelt = number_in_ours(field, mapped_.columns[k].theirs, number);
      if (!spelt) return std::unexpected(std::move(spelt).error());
      ours.push_back(*std::move(spelt));
    }
    write(ours, number);
    return {};
  }

  // A number with a decimal comma in ours. Refuses what could be a thousands separator.
  Read<std::string> number_in_ours(std::string field, const std::string& column,
                                   std::size_t number) {
    const auto refused = [&](const char* what, std::string expected) {
      return std::unexpected(Problem{path_, static_cast<int>(number), 0,
                                     fmt::format("{}: {} {}", column, in_quotes(field), what),
                                     std::move(expected)});
    };
    const auto commas = std::ranges::count(field, ',');
    const bool point = field.find('.') != std::string::npos;
    if (commas > 1 || (commas == 1 && point)) {
      return refused("has more than a decimal separator", "a number without thousands separators");
    }
    if (commas == 1 && mapped_.separator == ',') {
      return refused("may have a decimal comma or a thousands separator",
                     "decimal points where commas separate the columns; or columns separated by "
                     "semicolons or tabs");
    }
    if ((commas == 1 && decimal_point_) || (point && mapped_.decimal_comma)) {
      return refused("has another decimal separator than the lines before",
                     "points in all numbers, or commas in all");
    }
    mapped_.decimal_comma = mapped_.decimal_comma || commas == 1;
    decimal_point_ = decimal_point_ || point;
    std::ranges::replace(field, ',', '.');
    return field;
  }

  // Our lines have the numbers of theirs, so that a problem names the right one.
  void write(const std::vector<std::string>& fields, std::size_t number) {
    for (; written_ + 1 < number; ++written_) mapped_.text += '\n';
    mapped_.text += fmt::format("{}\n", fmt::join(fields, ","));
    ++written_;
  }

  std::string path_;
  Wanted wanted_;
  JointTypes types_;
  MappedMeasurements mapped_;
  Places places_;
  std::string first_line_;
  bool decimal_point_ = false;  // a number had one
  std::size_t preamble_ = 0;
  std::size_t written_ = 0;
};

}  // namespace

Read<MappedMeasurements> map_measurements(const std::string& path, std::string_view mapping,
                                          const JointTypes& types) {
  ARMSIG_TRY(wanted, wanted_of(mapping));
  ARMSIG_TRY(lines, LineReader::open(path));
  Mapper mapper(path, std::move(wanted), types);
  for (;;) {
    ARMSIG_TRY(more, lines.next());
    if (!more && !mapper.began()) {
      return std::unexpected(Problem{path, 0, 0, std::string(lines.what_it_is()),
                                     "a header line, then one row a line"});
    }
    if (!more) return std::move(mapper).finish();
    if (auto taken = mapper.take(lines.line(), lines.number()); !taken) {
      return std::unexpected(std::move(taken).error());
    }
  }
}

std::string in_words(const MappedMeasurements& mapped) {
  const char* separator = mapped.separator == ';'    ? "semicolons"
                          : mapped.separator == '\t' ? "tabs"
                                                     : "commas";
  std::string words = fmt::format("Columns (header in line {}, {}{})\n\n", mapped.header_line,
                                  separator, mapped.decimal_comma ? ", decimal commas" : "");
  for (const MappedColumn& column : mapped.columns) {
    words += fmt::format("  {:<10} from  {}\n", column.ours, column.theirs);
  }
  std::vector<std::string> ignored = mapped.ignored;
  std::erase(ignored, "");
  if (!ignored.empty()) words += fmt::format("  not used: {}\n", all_of(ignored));
  return words + "\n";
}

}  // namespace armsig::tool
