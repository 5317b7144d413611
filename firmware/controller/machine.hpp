// SPDX-License-Identifier: MIT
// The one machine that a signature belongs to.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/arm.hpp"
#include "hal/drive_identity.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::controller {

struct Machine {
  FixedVector<hal::DriveIdentity, kMaxJoints> drives;  // base to tip
  std::uint32_t drawing_crc = 0;
};

// CRC-32 of the rows and couplings of the drawing, as little-endian doubles; its limits are not in
// it.
[[nodiscard]] std::uint32_t drawing_crc(const Arm& drawing);

// Empty until every drive has told who it is.
[[nodiscard]] std::optional<Machine> machine_of(const Arm& drawing, const hal::JointDrives& drives);

struct MachineDifference {
  std::string_view what;             // "drive_serial", "gear_ratio", "drawing", ...
  std::optional<std::size_t> joint;  // from 0
  double found = 0;
  double expected = 0;
};

// The first thing in which `found` is not `expected`; empty where they are one. A number of a drive
// that either does not tell is not compared.
[[nodiscard]] std::optional<MachineDifference> difference(const Machine& expected,
                                                          const Machine& found);

}  // namespace armsig::controller
