// SPDX-License-Identifier: MIT
// One object of a device's dictionary, where what it holds is in the way of something.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace armsig::hal {

struct DeviceObject {
  std::uint16_t index = 0;  // 0: no object is
  std::uint8_t subindex = 0;
  std::optional<std::uint32_t> found;  // empty: the device did not tell, or has no such object
  std::optional<std::uint32_t> wanted;

  friend bool operator==(const DeviceObject&, const DeviceObject&) = default;
};

// What a CANopen emergency has beside its code, for the manual of its maker: the error register
// (1001h) and five bytes.
#ifdef ARMSIG_SMALL_IMAGE
struct DeviceDetails {};
#else
struct DeviceDetails {
  std::uint8_t error_register = 0;
  std::array<std::uint8_t, 5> own{};

  friend bool operator==(const DeviceDetails&, const DeviceDetails&) = default;
};
#endif

}  // namespace armsig::hal
