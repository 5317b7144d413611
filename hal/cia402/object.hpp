// SPDX-License-Identifier: MIT
// The objects of a drive by index, as every transport of CiA 402 reads and writes them one at a
// time: SDO of CANopen, CoE of EtherCAT.
#pragma once

#include <cstdint>
#include <expected>

#include "core/base/error.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::cia402 {

struct ObjectRequest {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t bytes = 0;  // written: 1, 2 or 4; 0 reads the object
  std::uint32_t value = 0;
};

struct ObjectFailure {
  Error error = Error::kSdoTimeout;  // or kSdoAborted
  std::uint32_t abort_code = 0;      // as the device sent it

  friend bool operator==(const ObjectFailure&, const ObjectFailure&) = default;
};

// The value read (little-endian, zero-extended), or the value written.
using ObjectOutcome = std::expected<std::uint32_t, ObjectFailure>;

// Abort codes that callers tell apart; those of CoE are the same (CiA 301, 7.2.4.3.17).
inline constexpr std::uint32_t kAbortNoObject = 0x06020000;
inline constexpr std::uint32_t kAbortNoSubindex = 0x06090011;

// What a cycle carries, whichever way: from the master controlword and target, from the drive
// statusword and position, and its torque where that is watched.
inline constexpr std::uint16_t kControlWord = 0x6040;
inline constexpr std::uint16_t kStatusWord = 0x6041;
inline constexpr std::uint16_t kActualPosition = 0x6064;
inline constexpr std::uint16_t kActualTorque = 0x6077;  // of the rated torque, per mille
inline constexpr std::uint16_t kTargetPosition = 0x607A;
inline constexpr std::uint16_t kInterpolationData = 0x60C1;  // sub-index 1: the next position

// What a set-up is about, besides.
inline constexpr std::uint16_t kDeviceType = 0x1000;  // of CiA 301: the number of the profile
inline constexpr std::uint16_t kGuardTime = 0x100C;   // of CiA 301: node guarding
inline constexpr std::uint16_t kLifeFactor = 0x100D;
inline constexpr std::uint16_t kHeartbeatProducer = 0x1017;
inline constexpr std::uint16_t kHeartbeatConsumer = 0x1016;    // of CiA 301, sub-index 1
inline constexpr std::uint16_t kReceivePdoParameter = 0x1400;  // sub-index 5: its time-out
inline constexpr std::uint16_t kAbortConnectionOption = 0x6007;
inline constexpr std::uint16_t kQuickStopOption = 0x605A;
inline constexpr std::uint16_t kShutdownOption = 0x605B;
inline constexpr std::uint16_t kDisableOperationOption = 0x605C;
inline constexpr std::uint16_t kFaultReactionOption = 0x605E;
inline constexpr std::uint16_t kModeOfOperation = 0x6060;
inline constexpr std::uint16_t kModeDisplay = 0x6061;
inline constexpr std::uint16_t kQuickStopDeceleration = 0x6085;
inline constexpr std::uint16_t kHomingMethod = 0x6098;
inline constexpr std::uint16_t kSupportedModes = 0x6502;
inline constexpr std::uint16_t kLogicalDeviceType = 0x67FF;  // of one axis of several
inline constexpr std::uint32_t kModeHoming = 6;              // of 6060h

// A device with several axes has the objects of the profile and the PDOs once an axis, each axis so
// much further (CiA 301, object 1000h and CiA 402-2): of the second axis the controlword is 6840h,
// the parameter of RPDO1 is 1440h.
inline constexpr std::uint16_t kFirstProfileObject = 0x6000;
inline constexpr std::uint16_t kProfileObjects = 0x800;  // of an axis
inline constexpr std::uint16_t kEndOfPdos = 0x1C00;      // from kReceivePdoParameter on
inline constexpr std::uint16_t kPdos = 0x40;             // of an axis
inline constexpr std::uint16_t kPdoParameters = 0x200;   // of one kind, of all axes

// An axis of a device, from 1. An image with little memory knows the first alone.
inline constexpr std::uint8_t kMostAxes = hal::kSmallImage ? 1 : 4;

[[nodiscard]] constexpr bool is_of_pdo(std::uint16_t index) {
  return index >= kReceivePdoParameter && index < kEndOfPdos;
}
// Where the `axis` has what the first one has at `index`. What is of the whole device stays.
[[nodiscard]] constexpr std::uint16_t object_of_axis(std::uint8_t axis, std::uint16_t index) {
  if (kMostAxes == 1) return index;
  const unsigned further = axis - 1U;
  if (is_of_pdo(index)) return static_cast<std::uint16_t>(index + further * kPdos);
  if (index < kFirstProfileObject) return index;
  return static_cast<std::uint16_t>(index + further * kProfileObjects);
}
// What the first axis has where another one has `index`.
[[nodiscard]] constexpr std::uint16_t object_of_first_axis(std::uint16_t index) {
  if (kMostAxes == 1) return index;
  if (is_of_pdo(index)) {
    return static_cast<std::uint16_t>(index - index % kPdoParameters + index % kPdos);
  }
  if (index < kFirstProfileObject) return index;
  return static_cast<std::uint16_t>(kFirstProfileObject + index % kProfileObjects);
}

}  // namespace armsig::cia402
