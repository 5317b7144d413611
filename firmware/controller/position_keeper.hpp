// SPDX-License-Identifier: MIT
// Where the joints were when the torque was last taken off, kept over a loss of power: an encoder
// that has lost its count shows by it at the next power-up.
//
// One sector of non-volatile memory, a page for each time, erased when it is full; the valid page
// with the largest number counts. A write that power cuts short costs at most what was kept.
// Little- endian:
//
//   offset  bytes
//        0      4  magic "APOS"
//        4      2  version, 1
//        6      2  joints, n
//        8      4  number
//       12     64  readings, 8 doubles; unused ones zero
//       76      4  CRC-32 of all before
#pragma once

#include <optional>

#include "core/base/arm.hpp"
#include "hal/joint_drives.hpp"
#include "hal/nonvolatile_memory.hpp"

namespace armsig::controller {

class PositionKeeper {
 public:
  // Nothing is kept where the memory has no such sector.
  PositionKeeper(hal::NonvolatileMemory& memory, std::size_t sector)
      : memory_(memory), sector_(sector) {}

  // What was kept last; empty: nothing, or not of so many joints. Also finds out where to write.
  [[nodiscard]] std::optional<JointVector> load(std::size_t joints);

  // Begins to keep `positions`, unless they are what is kept already. Precondition: load().
  void begin(const JointVector& positions);
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
  std::optional<JointVector> kept_;
  std::optional<JointVector> writing_;
};

// Keeps where `drives` are, at the end of a controller that is no longer run: if none has torque.
void keep_positions(hal::NonvolatileMemory& memory, const hal::JointDrives& drives);

}  // namespace armsig::controller
