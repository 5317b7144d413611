// SPDX-License-Identifier: MIT
// The CAN buses that the drives of one arm are on. An image with little memory has one, and keeps
// no number or name of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/fixed_vector.hpp"
#include "hal/can_bus.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::canopen {

inline constexpr std::uint8_t kMostBuses = hal::kSmallImage ? 1 : 2;

#ifdef ARMSIG_SMALL_IMAGE
struct BusNumber {
  constexpr BusNumber() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): it stands for the number that others have
  constexpr BusNumber(std::uint8_t /*first*/) {}
  // NOLINTNEXTLINE(google-explicit-constructor)
  constexpr operator std::uint8_t() const { return 0; }
};
struct BusName {
  constexpr BusName() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): it stands for the name that others have
  constexpr BusName(std::string_view /*name*/) {}
  // NOLINTNEXTLINE(google-explicit-constructor)
  constexpr operator std::string_view() const { return {}; }
};
struct Buses {
  static constexpr std::uint8_t count = 1;
  static constexpr std::uint8_t sink = 0;
};
#else
using BusNumber = std::uint8_t;    // from 0
using BusName = std::string_view;  // for people
struct Buses {
  std::uint8_t count = 1;  // of kMostBuses
  std::uint8_t sink = 0;   // whose frames of others are passed on
};
#endif

// A bus, and what people call it, of static storage; that may be empty.
struct NamedBus {
  hal::CanBus* bus = nullptr;
  [[no_unique_address]] BusName name;
};
using NamedBuses = FixedVector<NamedBus, kMostBuses>;

}  // namespace armsig::canopen
