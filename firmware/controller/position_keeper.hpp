// SPDX-License-Identifier: MIT
// Where the joints stood without torque, and which of them are not known to, kept over a loss of
// power: an encoder that has lost its count shows by it at the next power-up.
//
// One sector of non-volatile memory, a page for each time, erased when it is full; the valid page
// with the largest number counts. A write that power cuts short costs at most what was kept.
// Little- endian:
//
//   offset  bytes
//        0      4  magic "APOS"
//        4      2  version, 2
//        6      2  joints, n
//        8      4  number
//       12     64  readings, 8 doubles; unused ones zero
//       76      1  a bit for each joint that is unreferenced (references.hpp)
//       77      1  a bit for each of those that another drive is the only reason for
//       78      2  zero
//       80     32  marks of the drives, 8 times 4; unused ones zero
//      112      4  CRC-32 of all before
#pragma once

#include <optional>

#include "core/base/arm.hpp"
#include "hal/nonvolatile_memory.hpp"

namespace armsig::controller {

// Of each drive, as mark_of() has it; 0: it does not say who it is.
using DriveMarks = FixedVector<std::uint32_t, kMaxJoints>;

struct RestRecord {
  JointVector positions;
  std::uint8_t unreferenced = 0;  // bit per joint
  std::uint8_t by_drive = 0;      // those that another drive is the only reason for
  DriveMarks drives;              // that told the positions when they were last known to be right
};

class PositionKeeper {
 public:
  // Nothing is kept where the memory has no such sector.
  PositionKeeper(hal::NonvolatileMemory& memory, std::size_t sector)
      : memory_(memory), sector_(sector) {}

  // What was kept last; empty: nothing, or not of so many joints. Also finds out where to write.
  [[nodiscard]] std::optional<RestRecord> load(std::size_t joints);

  // Begins to keep `rest`, unless it is what is kept already. Preconditions: load(); as many drives
  // as positions.
  void begin(const RestRecord& rest);
  [[nodiscard]] bool is_writing() const { return writing_.has_value(); }
  // One erase or one page. What fails is given up: nothing depends on it. Precondition:
  // is_writing().
  void step();

 private:
  [[nodiscard]] bool fits() const;

  hal::NonvolatileMemory& memory_;
  std::size_t sector_;
  std::size_t next_page_ = 0;
  std::uint32_t number_ = 0;
  std::optional<RestRecord> kept_;
  std::optional<RestRecord> writing_;
};

}  // namespace armsig::controller
