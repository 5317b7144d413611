// SPDX-License-Identifier: MIT
#include "host_tests/support/drive_tables.hpp"

#include <cstddef>
#include <fstream>
#include <utility>

namespace armsig::test {
namespace {

using simulated::Access;
using simulated::ObjectEdit;

constexpr std::uint32_t kSupportsCsp = 0x80;
constexpr std::uint32_t kAnyMode = 0xE1;     // of those that are emulated
constexpr std::uint32_t kWithoutCsp = 0x65;  // profile position and velocity, homing, interpolation

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

class Row {
 public:
  Row(const std::vector<std::string>& names, const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < names.size() && i < cells.size(); ++i) cells_[names[i]] = cells[i];
  }
  // Empty where there is no such column.
  [[nodiscard]] const std::string& operator[](const std::string& name) const {
    static const std::string none;
    const auto found = cells_.find(name);
    return found == cells_.end() ? none : found->second;
  }
  [[nodiscard]] bool says(const std::string& name, std::string_view words) const {
    return (*this)[name].find(words) != std::string::npos;
  }
  // The last number in hexadecimal.
  [[nodiscard]] std::optional<std::uint32_t> hex(const std::string& name) const {
    const std::string& cell = (*this)[name];
    const std::size_t at = cell.rfind("0x");
    if (at == std::string::npos) return std::nullopt;
    return static_cast<std::uint32_t>(std::stoul(cell.substr(at), nullptr, 16));
  }

 private:
  std::map<std::string, std::string> cells_;
};

void add(DriveTable& table, std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes,
         Access access, std::uint32_t value) {
  table.edits.push_back({.object = {index, subindex, bytes, access, value}});
}

// What such an object does where nobody can tell it, it does all the same: `value`.
void remove(DriveTable& table, std::uint16_t index, std::uint32_t value = 0) {
  add(table, index, ObjectEdit::kWhole, 0, Access::kAbsent, value);
}

// "rw", "rw (2)", "ro (0)", "absent".
void add_option(DriveTable& table, const Row& row, const std::string& column, std::uint16_t index,
                std::uint32_t usual) {
  const std::string& cell = row[column];
  const std::size_t at = cell.find('(');
  const std::uint32_t value =
      at == std::string::npos ? usual : static_cast<std::uint32_t>(std::stoul(cell.substr(at + 1)));
  if (cell == "absent") {
    remove(table, index, usual);
  } else {
    add(table, index, 0, 2, cell.starts_with("ro") ? Access::kReadOnly : Access::kReadWrite, value);
  }
}

void add_quotient(DriveTable& table, std::uint16_t index, std::uint32_t over) {
  add(table, index, 0, 1, Access::kReadOnly, 2);
  add(table, index, 1, 4, Access::kReadWrite, over);
  add(table, index, 2, 4, Access::kReadWrite, 1);
}

// "absent (6093h 6094h)", "608F only", or three quotients over 1.
void add_factors(DriveTable& table, const Row& row) {
  const std::string column = "608F/6091/6092";
  const std::string& cell = row[column];
  if (row.says(column, "6093h")) add_quotient(table, 0x6093, 1);
  if (cell.starts_with("absent")) return;
  if (row.says(column, "only")) {
    add_quotient(table, 0x608F, static_cast<std::uint32_t>(table.counts_per_revolution));
    return;
  }
  std::size_t at = 0;
  for (std::uint16_t index = 0x608F; index <= 0x6092; ++index) {
    if (index == 0x6090) continue;
    const auto over = static_cast<std::uint32_t>(std::stoul(cell.substr(at)));
    add_quotient(table, index, over);
    if (index == 0x608F) table.counts_per_revolution = over;
    at = cell.find(',', at) + 1;
  }
}

void add_modes(DriveTable& table, const Row& row) {
  const auto modes = row.hex("6502h");
  if (row["6502h"] == "-") {
    remove(table, 0x6502, kAnyMode);
  } else {
    const bool lacks = row.says("6502h", "no CSP");
    add(table, 0x6502, 0, 4, Access::kReadOnly, modes.value_or(lacks ? kWithoutCsp : kSupportsCsp));
  }
}

void add_cycle(DriveTable& table, const Row& row) {
  if (row["60C2h:1"] == "absent") {
    remove(table, 0x60C2, 1);
    // Its own cycle, which nobody sees: a thousandth of a second.
    add(table, 0x60C2, 2, 0, Access::kAbsent, 0xFD);
  }
  ObjectEdit cycle{.object = {0x60C2, 1, 1, Access::kReadWrite, 1}};
  if (row.says("60C2h:1", "only")) cycle.lowest = cycle.highest = 1;
  if (row.says("60C2h:1", "..100")) cycle.highest = 100;
  if (row["60C2h:1"] != "absent") table.edits.push_back(cycle);
}

DriveTable table_of(const Row& row) {
  DriveTable table;
  table.name = row["device"];
  table.outcome = row["outcome"];
  if (row["1016h"] == "absent") remove(table, 0x1016);
  if (row["1400h:5"] == "rw") add(table, 0x1400, 5, 2, Access::kReadWrite, 0);
  if (row["100Ch"] == "rw") {
    add(table, 0x100C, 0, 2, Access::kReadWrite, 0);
    add(table, 0x100D, 0, 1, Access::kReadWrite, 0);
  }
  add_modes(table, row);
  add_cycle(table, row);
  if (row["607Ah mappable"].starts_with("NO")) add(table, 0x607A, 0, 4, Access::kReadWrite, 0);
  add_option(table, row, "605A", 0x605A, 2);
  add_option(table, row, "605B", 0x605B, 1);
  add_option(table, row, "605C", 0x605C, 1);
  add_option(table, row, "605E", 0x605E, 2);
  add_option(table, row, "6007h", 0x6007, row["6007h"] == "absent" ? 0 : 1);
  add_factors(table, row);
  if (const auto unit = row.hex("60A8h")) add(table, 0x60A8, 0, 4, Access::kReadOnly, *unit);
  if (const auto unit = row.hex("60AAh")) {
    add(table, 0x60AA, 0, 4, Access::kReadOnly, *unit);
    table.ramp_turns = 1.0 / 60;  // revolutions a minute and second
  }
  table.shows_mode_late = row["6061h"] == "late";
  table.boots_quietly = row["boot-up"] == "after 81h";
  return table;
}

}  // namespace

void DriveTable::apply(simulated::DriveConfiguration& drive) const {
  drive.edits = edits;
  drive.ramp_unit = ramp_turns > 0 ? ramp_turns * counts_per_revolution : 1;
  drive.shows_mode_late = shows_mode_late;
  drive.boots_quietly = boots_quietly;
}

simulated::DriveConfiguration DriveTable::drive() const {
  simulated::DriveConfiguration drive;
  drive.sync_loss_periods = 0;
  apply(drive);
  return drive;
}

std::vector<DriveTable> read_drive_tables(const std::string& path) {
  std::vector<DriveTable> tables;
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) return tables;
  const auto names = cells_of(line);
  while (std::getline(file, line)) tables.push_back(table_of(Row(names, cells_of(line))));
  return tables;
}

std::vector<DriveTable> invented_drive_tables() { return read_drive_tables(ARMSIG_DRIVES); }

std::vector<DriveTable> shared_drive_tables() {
  return read_drive_tables(ARMSIG_SHARED_DATA "/drives/objects.csv");
}

}  // namespace armsig::test
