// SPDX-License-Identifier: MIT
// What must be known of drives to command and to watch them, however they are reached.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "core/base/arm.hpp"
#include "hal/cia402/scaling.hpp"
#include "hal/clock.hpp"

namespace armsig::cia402 {

// Of one drive.
struct DriveSettings {
  ScalingConfiguration scaling;
  JointLimits limits;           // of the targets, radians or metres
  double largest_speed = 0;     // of the targets, rad/s or m/s
  double following_window = 0;  // object 6065h, radians or metres; 0 keeps the drive's own
  // Object 6085h, rad/s^2 or m/s^2, told in the drive's own unit; 0 keeps its own.
  double stop_deceleration = 0;
  // It is known, and seen to otherwise, that the drive keeps its torque when its master is gone.
  bool unsupervised_known = false;
  // It is known that the drive warns (bit 7), for instance of its battery: no reason to stop.
  bool warning_known = false;
  // Object 6098h, told before the drive homes; empty keeps its own.
  std::optional<std::int8_t> homing_method{};
};

// How long an enabled drive may say these of itself before it counts as faulted.
struct StatusLimits {
  hal::Duration ignores = std::chrono::milliseconds(300);     // bit 12 clear; longer than a brake
  hal::Duration limits = std::chrono::milliseconds(500);      // bit 11 set
  hal::Duration lags = std::chrono::milliseconds(100);        // bit 13 set
  hal::Duration warns = std::chrono::milliseconds(2000);      // bit 7 set
  hal::Duration no_voltage = std::chrono::milliseconds(100);  // bit 4 clear
};

// Of all drives of an arm.
struct GroupSettings {
  hal::Duration period = std::chrono::milliseconds(2);  // of the tick
  hal::Duration transition_timeout = std::chrono::seconds(1);
  // From a stop until the positions stand; then the torque may go whether they do or not.
  hal::Duration stop_timeout = std::chrono::milliseconds(1500);
  StatusLimits status_limits;
  hal::Duration homing_timeout = std::chrono::seconds(120);  // from its start to its end
};

}  // namespace armsig::cia402
