// SPDX-License-Identifier: MIT
// What must be known of drives to command and to watch them, however they are reached.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>

#include "core/base/arm.hpp"
#include "core/base/fixed_vector.hpp"
#include "hal/cia402/object.hpp"
#include "hal/cia402/scaling.hpp"
#include "hal/clock.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::cia402 {

// How a drive is given its targets; by the values of 6060h.
enum class PositionMode : std::uint8_t {
  kProfile = 1,       // one after the other, each by a profile of the drive's own
  kInterpolated = 7,  // in every cycle, by 60C1h
  kCyclic = 8,        // in every cycle, by 607Ah: cyclic synchronous position
};

// What a configuration may write besides, of one drive; nothing where there is no memory for it.
inline constexpr std::size_t kMaxFurtherWrites = hal::kOtherModes ? 8 : 0;
struct NoWrites {
  [[nodiscard]] static constexpr const ObjectRequest* data() { return nullptr; }
  [[nodiscard]] static constexpr std::size_t size() { return 0; }
};
using FurtherWrites =
    std::conditional_t<hal::kOtherModes, FixedVector<ObjectRequest, kMaxFurtherWrites>, NoWrites>;

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
  // Its torque (6077h) is told in every cycle.
  bool torque_told = false;
  // Object 6098h, told before the drive homes; empty keeps its own.
  std::optional<std::int8_t> homing_method{};
  PositionMode mode = PositionMode::kCyclic;
  // Objects that are written besides, before the mode; each may_be_written() (setup.hpp).
  [[no_unique_address]] FurtherWrites writes{};
  [[no_unique_address]] hal::AxisNumber axis = 1;

  // Where the device has what the first axis has at `index`.
  [[nodiscard]] constexpr std::uint16_t object(std::uint16_t index) const {
    return object_of_axis(axis, index);
  }
  // Where the image has no others, that is known to the compiler.
  [[nodiscard]] constexpr PositionMode position_mode() const {
    return hal::kOtherModes ? mode : PositionMode::kCyclic;
  }
  [[nodiscard]] constexpr bool tells_torque() const { return hal::kTellsTorque && torque_told; }
  [[nodiscard]] constexpr std::span<const ObjectRequest> further_writes() const {
    return {writes.data(), writes.size()};
  }
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
