// SPDX-License-Identifier: MIT
// What the cabinet of a Puma 560 is told: drives on CAN nodes 1 to 6, an ultrasonic sensor of six
// receivers on node 32.
#pragma once

#include "firmware/controller/configuration.hpp"
#include "hal/canopen/configuration.hpp"
#include "hal/canopen/range_sensor.hpp"

namespace armsig::cabinet {

inline constexpr std::size_t kReceivers = 6;
inline constexpr std::uint32_t kBitsPerSecond = 1'000'000;              // of the drives' CAN bus
inline constexpr hal::Duration kPeriod = std::chrono::milliseconds(2);  // of the tick and of SYNC

// In the sensor frame, metres.
[[nodiscard]] FixedVector<Vector3, kReceivers> receivers_S();
[[nodiscard]] controller::Configuration controller_configuration();
[[nodiscard]] canopen::Configuration drive_configuration();
[[nodiscard]] canopen::RangeNodeConfiguration sensor_configuration();

}  // namespace armsig::cabinet
