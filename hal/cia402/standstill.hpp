// SPDX-License-Identifier: MIT
// When a joint counts as standing still.
#pragma once

#include <chrono>

#include "hal/cia402/scaling.hpp"
#include "hal/clock.hpp"

namespace armsig::cia402 {

// A joint that goes less far than this speed would take it, in this time, stands.
inline constexpr double kRestSpeed_rad = 8.7e-3;  // a second; half a degree
inline constexpr double kRestSpeed_m = 1e-3;
inline constexpr hal::Duration kRestTime = std::chrono::milliseconds(50);
// Older than this, or than these periods, a position tells nothing about standing.
inline constexpr hal::Duration kFreshPosition = std::chrono::milliseconds(50);
inline constexpr int kFreshPeriods = 5;

// How far that is, and what the encoder may flicker besides; rad or m.
[[nodiscard]] inline double rest_tolerance(JointType type, const Scaling& scaling) {
  const double speed = type == JointType::kRevolute ? kRestSpeed_rad : kRestSpeed_m;
  return speed * hal::seconds(kRestTime) + 2 * scaling.resolution();
}

}  // namespace armsig::cia402
