// SPDX-License-Identifier: MIT
// Numbers of CiA 301: the predefined connection set, network management, little-endian fields.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include "core/base/check.hpp"
#include "hal/can_bus.hpp"

namespace armsig::canopen {

using NodeId = std::uint8_t;  // 1 to 127

inline constexpr NodeId kLargestNode = 127;

// Function codes of the predefined connection set (CiA 301, 7.3.5); a node's COB-ID is the function
// code plus its node number. PDO directions are named as the device sees them.
inline constexpr std::uint32_t kNmtId = 0x000;
inline constexpr std::uint32_t kSyncId = 0x080;
inline constexpr std::uint32_t kEmergencyId = 0x080;
inline constexpr std::uint32_t kTransmitPdo1Id = 0x180;
inline constexpr std::uint32_t kReceivePdo1Id = 0x200;
inline constexpr std::uint32_t kTransmitPdo2Id = 0x280;
inline constexpr std::uint32_t kTransmitPdo3Id = 0x380;
inline constexpr std::uint32_t kTransmitPdo4Id = 0x480;
inline constexpr std::uint32_t kNextPdo = 0x100;  // from PDO1 to PDO2, and so on
inline constexpr std::uint32_t kSdoResponseId = 0x580;
inline constexpr std::uint32_t kSdoRequestId = 0x600;
inline constexpr std::uint32_t kHeartbeatId = 0x700;
inline constexpr std::uint32_t kFunctionMask = 0x780;
inline constexpr std::uint32_t kNodeMask = 0x07F;

// Flags in the COB-ID of a PDO, subindex 1 of its communication parameter (CiA 301, 7.5.2.35): the
// PDO does not exist; it answers no remote frame.
inline constexpr std::uint32_t kPdoOff = 1U << 31;
inline constexpr std::uint32_t kNoRemote = 1U << 30;

// Lengths of the PDOs of this system: 6040h with 607Ah, 6041h with 6064h.
inline constexpr std::uint8_t kDrivePdoBytes = 6;
inline constexpr std::uint8_t kTorqueBytes = 2;  // behind them, of a drive that tells its torque

// Network management commands (CiA 301, 7.2.8.3.1).
enum class NmtCommand : std::uint8_t {
  kStart = 0x01,
  kStop = 0x02,
  kEnterPreOperational = 0x80,
  kResetNode = 0x81,
  kResetCommunication = 0x82,
};

// Network management states as a heartbeat tells them (CiA 301, 7.2.8.3.2.1).
enum class NmtState : std::uint8_t {
  kBootUp = 0x00,
  kStopped = 0x04,
  kOperational = 0x05,
  kPreOperational = 0x7F,
};

template <std::unsigned_integral T>
constexpr void store(hal::CanFrame& frame, std::size_t at, T value) {
  ARMSIG_CHECK(at + sizeof(T) <= hal::kMaxCanData);
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    frame.data[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

template <std::unsigned_integral T>
[[nodiscard]] constexpr T load(const hal::CanFrame& frame, std::size_t at) {
  ARMSIG_CHECK(at + sizeof(T) <= hal::kMaxCanData);
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    value = static_cast<T>(value | static_cast<T>(static_cast<T>(frame.data[at + i]) << (8 * i)));
  }
  return value;
}

[[nodiscard]] constexpr hal::CanFrame nmt_frame(NmtCommand command, NodeId node) {
  return {.id = kNmtId, .length = 2, .data = {static_cast<std::uint8_t>(command), node}};
}

[[nodiscard]] constexpr hal::CanFrame sync_frame() { return {.id = kSyncId}; }

// Asks a guarded node whether it is there (CiA 301, 7.2.8.3.2.1).
[[nodiscard]] constexpr hal::CanFrame guard_frame(NodeId node) {
  return {.id = kHeartbeatId + node, .remote = true, .length = 1};
}

[[nodiscard]] constexpr hal::CanFrame heartbeat_frame(NodeId node, NmtState state) {
  return {.id = kHeartbeatId + node, .length = 1, .data = {static_cast<std::uint8_t>(state)}};
}

}  // namespace armsig::canopen
