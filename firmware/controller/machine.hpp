// SPDX-License-Identifier: MIT
// The one machine that a signature belongs to.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/arm.hpp"
#include "firmware/controller/text.hpp"
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

// CRC-32 of what the drive says of itself, and of its axis where that is not the first; 0: it does
// not say who it is.
[[nodiscard]] std::uint32_t mark_of(const hal::DriveIdentity& drive);

struct MachineDifference {
  std::string_view what;             // "drive_serial", "gear_ratio", "nominal_model", ...
  std::optional<std::size_t> joint;  // from 0
  double found = 0;
  double expected = 0;
};

// ` what=drive_serial joint=3 found=2003.000 expected=1003.000`.
void tell(const MachineDifference& difference, Line& line);

// Whether another amplifier is a difference. A signature is of what fixes where a joint's reading
// is zero: it outlives an amplifier, whose joint is unreferenced until somebody has looked
// (references.hpp).
enum class Amplifiers : std::uint8_t { kCompared, kIgnored };

// The first thing in which `found` is not `expected`; empty where they are one. A number of a drive
// that either does not tell is not compared.
[[nodiscard]] std::optional<MachineDifference> difference(
    const Machine& expected, const Machine& found, Amplifiers amplifiers = Amplifiers::kCompared);

}  // namespace armsig::controller
