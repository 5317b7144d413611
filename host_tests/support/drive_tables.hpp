// SPDX-License-Identifier: MIT
// Tables of what drives have, made into emulated drives: those of the shared data, and some that
// were invented for the tests (host_tests/support/drives.csv).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/simulated/drive.hpp"

namespace armsig::test {

struct DriveTable {
  std::string name;
  std::vector<simulated::ObjectEdit> edits;
  double counts_per_revolution = 4000;  // of its encoder
  double ramp_turns = 0;  // a unit of 6085h in turns of the motor a second squared; 0: counts
  bool shows_mode_late = false;
  bool boots_quietly = false;
  std::string outcome;  // "moves", or the object by which it is refused: "605Ah:0"; empty: not told

  // Makes `drive` one of this table, which must outlive it.
  void apply(simulated::DriveConfiguration& drive) const;
  // An ideal drive of this table, which must outlive it; it does not watch SYNC.
  [[nodiscard]] simulated::DriveConfiguration drive() const;
};

// One table a row.
[[nodiscard]] std::vector<DriveTable> read_drive_tables(const std::string& path);
[[nodiscard]] std::vector<DriveTable> invented_drive_tables();
// Empty where the shared data are absent.
[[nodiscard]] std::vector<DriveTable> shared_drive_tables();

}  // namespace armsig::test
