// SPDX-License-Identifier: MIT
// A CSV file with a header line: named columns with units, rows of numbers in SI, read one row at a
// time. Strict: every column known and given once, every field a finite number or, where that is
// allowed, empty.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/arm.hpp"
#include "firmware/formats/csv_lines.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/table_cells.hpp"
#include "firmware/formats/table_numbers.hpp"
#include "firmware/formats/units.hpp"

namespace armsig::tool {

// What a column may hold. Its name in the header is `name`, and the unit if the dimension has any.
struct Quantity {
  std::string name;
  Dimension dimension = Dimension::kNone;
  bool required = true;  // the column must be there
  bool may_be_empty = false;
  // Said with a wrong unit: "joint 1 is revolute". (Without {}, g++ calls it missing where it is
  // left out.)
  std::string note = {};  // NOLINT(readability-redundant-member-init)
};

// The joint readings q1 ... qn, in the units that the joint types allow.
[[nodiscard]] std::vector<Quantity> joint_quantities(const JointTypes& types);

class CsvTable {
 public:
  // How the fields are written. kForeign: as spreadsheets and people write them too, separated by
  // what the header has of semicolons, tabs, commas and blanks, with decimal commas where no comma
  // separates, angles in radians as pi/2, and infinity where there is no unit.
  enum class Style : std::uint8_t { kOurs, kForeign };

  // Reads as far as the header line. Values and problems below are addressed by the index of a
  // quantity in `quantities`.
  [[nodiscard]] static Read<CsvTable> open(LineReader lines, std::vector<Quantity> quantities,
                                           Style style = Style::kOurs);

  [[nodiscard]] bool has(std::size_t quantity) const;

  // Moves to the next row; false at the end of the file.
  [[nodiscard]] Read<bool> next();

  // What the header says of a column that is there.
  [[nodiscard]] const Unit& unit(std::size_t quantity) const;
  [[nodiscard]] const std::string& header(std::size_t quantity) const;

  // In SI (integers as they are); NaN where the field is empty, text, or the column absent.
  [[nodiscard]] double value(std::size_t quantity) const { return values_[quantity]; }

  [[nodiscard]] std::size_t line() const { return lines_.number(); }
  [[nodiscard]] std::optional<double> progress() const { return lines_.progress(); }

  // A problem with the whole header or row, or with one field of it.
  [[nodiscard]] std::unexpected<Problem> problem(std::string what, std::string expected) const;
  [[nodiscard]] std::unexpected<Problem> problem(std::size_t quantity, std::string what,
                                                 std::string expected) const;
  // The text of a field of the current line.
  [[nodiscard]] std::string_view field(std::size_t quantity) const;

 private:
  struct Column {
    std::size_t quantity = 0;
    Dimension dimension = Dimension::kNone;
    Unit unit;
    std::string name;  // as the header spells it
  };

  CsvTable(LineReader lines, std::vector<Quantity> quantities, Style style);
  [[nodiscard]] const Column& column_of(std::size_t quantity) const;
  [[nodiscard]] Cells cells() const { return {lines_.line(), separator_, Quotes::kAreText}; }
  [[nodiscard]] Read<void> read_header();
  [[nodiscard]] Read<Column> column_named(std::string_view name, std::size_t position) const;
  [[nodiscard]] std::unexpected<Problem> unknown_column(std::string_view name,
                                                        std::size_t position) const;
  [[nodiscard]] Read<void> parse_field(std::string_view text, const Column& column,
                                       std::size_t position);
  [[nodiscard]] Read<double> parse_value(std::string_view text, const Column& column,
                                         std::size_t position);
  [[nodiscard]] std::unexpected<Problem> at(std::size_t position, std::string what,
                                            std::string expected) const;

  LineReader lines_;
  Style style_ = Style::kOurs;
  char separator_ = ',';
  TableNumbers numbers_{','};
  std::vector<Quantity> quantities_;
  std::vector<Column> columns_;
  std::vector<double> values_;
};

}  // namespace armsig::tool
