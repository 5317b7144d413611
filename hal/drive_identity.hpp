// SPDX-License-Identifier: MIT
// Which drive moves a joint, and how it counts: what a signature is bound to.
#pragma once

#include <array>
#include <cstdint>

namespace armsig::hal {

// What a drive says of itself; 0: it does not say.
enum DeviceNumber : std::uint8_t { kVendor, kProduct, kRevision, kSerial, kDeviceNumbers };

// Which axis of a device with several it is, from 1. An image with little memory knows the first
// alone, and keeps no number of it.
#ifdef ARMSIG_SMALL_IMAGE
struct AxisNumber {
  constexpr AxisNumber() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): it stands for the number that others have
  constexpr AxisNumber(std::uint8_t /*first*/) {}
  // NOLINTNEXTLINE(google-explicit-constructor)
  constexpr operator std::uint8_t() const { return 1; }
};
#else
using AxisNumber = std::uint8_t;
#endif

struct DriveIdentity {
  std::array<std::uint32_t, kDeviceNumbers> device{};
  double counts_per_revolution = 0;  // of the motor's shaft
  double gear_ratio = 0;
  double lead_m = 0;             // prismatic: travel a revolution of the output
  std::int32_t zero_counts = 0;  // where the joint reading is zero
  bool reversed = false;
  [[no_unique_address]] AxisNumber axis = 1;

  friend bool operator==(const DriveIdentity&, const DriveIdentity&) = default;
};

}  // namespace armsig::hal
