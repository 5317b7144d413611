// SPDX-License-Identifier: MIT
// The motor, encoder and position loop of an emulated drive, in encoder counts and seconds.
#pragma once

#include <chrono>
#include <cstdint>

#include "hal/clock.hpp"

namespace armsig::simulated {

struct MotionConfiguration {
  double start = 0;                   // counts
  double largest_speed = 5e5;         // counts/s, of the motor
  double largest_acceleration = 5e6;  // counts/s^2
  double stop_deceleration = 5e6;     // counts/s^2, of every ramp to rest
  double bandwidth_hz = 25;           // of the critically damped position loop
};

enum class Drivetrain : std::uint8_t {
  kBraked,    // without torque, the brake holds
  kFollows,   // the position loop follows the interpolated target
  kStopping,  // decelerates to rest, then holds position by torque
};

struct MotionState {
  Drivetrain mode = Drivetrain::kBraked;
  double position = 0;
  double velocity = 0;
  // Interpolation from `from` to `to`, which is reached `period` after `since`.
  double from = 0;
  double to = 0;
  hal::Instant since;
  hal::Duration period{};
  bool blocked = false;  // the motor cannot turn
  hal::Instant now;
};

class DriveMotion {
 public:
  // Fixed step of the integration: a tenth of the position loop's time constant at 25 Hz.
  static constexpr hal::Duration kStep = std::chrono::microseconds(500);

  DriveMotion(const MotionConfiguration& configuration, hal::Instant now);

  [[nodiscard]] const MotionState& state() const { return s_; }
  [[nodiscard]] std::int32_t counts() const;
  [[nodiscard]] bool at_rest() const { return s_.velocity == 0; }
  // Interpolated target less actual position, counts.
  [[nodiscard]] double following_error() const;

  void enter(Drivetrain mode);
  void set_blocked(bool blocked) { s_.blocked = blocked; }
  // A new target, to be reached linearly `period` from now on (object 60C2h).
  void set_target(std::int32_t counts, hal::Duration period, hal::Instant now);
  // In whole steps; true if there was one.
  bool advance(hal::Instant until);

 private:
  [[nodiscard]] double reference(hal::Instant at) const;
  [[nodiscard]] double reference_velocity(hal::Instant at) const;
  void step();

  MotionConfiguration configuration_;
  MotionState s_;
};

}  // namespace armsig::simulated
