// SPDX-License-Identifier: MIT
// The ultrasonic sensor of the demonstration: eight receivers on a frame that hangs over the arm.
//
// A truncated pyramid, 2 m square at the bottom and 1 m square 0.8 m higher; its lower square hangs
// 1.2 m above the shoulder of a Puma 560, clear of everything that the arm reaches (1.06 m with a
// target on its hand), and it needs nothing around the arm. At 0.2 mm (1 sigma) per range the
// position of a target anywhere that it gets to has an error between 0.12 and 0.20 mm per axis
// (root mean square of the three; 0.15 mm on average), at most 0.24 mm in the worst axis. Eight
// receivers in the best possible directions would give 0.12 mm.
#pragma once

#include "core/base/pose.hpp"
#include "hal/simulated/ultrasonic_field.hpp"

namespace armsig::simulated {

inline constexpr double kDemoRangeSigma = 0.2e-3;  // metres

// Sensor frame S: origin in the centre of the lower square, z up, x and y towards its sides.
[[nodiscard]] UltrasonicConfig demo_sensor();

// The half-space that targets are in, seen from the receivers: below. A unit vector in S.
[[nodiscard]] inline Vector3 demo_sensor_facing() { return -Vector3::UnitZ(); }

// Frame 0 of the arm under the sensor, as carelessly as frames are hung: turned by 30 degrees,
// tilted by 2, 5 cm off centre.
[[nodiscard]] Pose demo_base_pose();

}  // namespace armsig::simulated
