// SPDX-License-Identifier: MIT
// The arm as it was built and the field of its range sensor, for the emulated arm and for the host
// simulation that it is compared with.
#pragma once

#include <cstdint>

#include "hal/simulated/arm.hpp"
#include "hal/simulated/ultrasonic_field.hpp"

namespace armsig::arm_r5f {

inline constexpr double kCountsPerRevolution = 4000;
inline constexpr double kGearRatio = 100;

// Robot 1 of Table 2, with a target on its hand, before the sensor.
[[nodiscard]] simulated::SimulatedArm arm();
// Readings at power-up.
[[nodiscard]] JointVector start();
// `seed` decides by how much each receiver measures too long (1 sigma 0.2 mm). There is no noise
// from ping to ping, so that what is identified does not depend on when which ping was sent.
[[nodiscard]] simulated::UltrasonicConfig field(std::uint64_t seed);

}  // namespace armsig::arm_r5f
