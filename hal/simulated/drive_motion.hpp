// SPDX-License-Identifier: MIT
// The motor, its brake, encoder and position loop of an emulated drive, in encoder counts and
// seconds.
#pragma once

#include <chrono>
#include <cstdint>

#include "hal/clock.hpp"

namespace armsig::simulated {

// The defaults are an ideal joint: nothing pulls, the brake holds at once. honest_motion() is a
// real one.
struct MotionConfiguration {
  double start = 0;                   // counts
  double largest_speed = 5e5;         // counts/s, of the motor
  double largest_acceleration = 5e6;  // counts/s^2
  double stop_deceleration = 5e6;     // counts/s^2, of every ramp, until 6084h or 6085h is written
  double bandwidth_hz = 25;           // of the critically damped position loop
  double gravity = 0;                 // counts/s^2 that pull where nothing holds; signed; at first
  double friction = 0;                // counts/s^2 by which a motor without torque slows down
  hal::Duration brake_delay{};        // until the brake has closed, or opened
  double brake_deceleration = 0;      // counts/s^2 of the closed brake; 0: it stops at once
  double droop = 0;                   // counts that the loop stays off its target for ever; signed
  double compliance_s2 = 0;           // the same, in counts for each count/s^2 of gravity
  double play = 0;                    // counts between motor and joint
  double rated_acceleration = 0;      // counts/s^2 by the rated torque; 0: none is told
};

// A joint of a small arm: 180 deg/s^2 on its ramps, a limb that falls at 3 rad/s^2 until
// set_gravity() says otherwise and coasts, a brake that takes 60 ms, a position loop that stays a
// microradian off its target for each rad/s^2 of gravity, and 0.003 degrees of play: at a metre
// half of the 0.1 mm within which a Puma 560 repeats. Its rated torque accelerates it by 20
// rad/s^2. Precondition: counts_per_radian is positive.
[[nodiscard]] MotionConfiguration honest_motion(double counts_per_radian);
// A slide: 2 m/s^2 on its ramps, 10 micrometres of play, 20 m/s^2 by its rated torque.
// Precondition: counts_per_metre is positive.
[[nodiscard]] MotionConfiguration honest_slide(double counts_per_metre);

enum class Drivetrain : std::uint8_t {
  kBraked,    // without torque: coasts and falls until the brake has closed
  kFollows,   // the position loop follows the interpolated target, once the brake has opened
  kStopping,  // decelerates to rest, then holds position by torque
};

struct MotionState {
  Drivetrain mode = Drivetrain::kBraked;
  double position = 0;
  double velocity = 0;
  double joint = 0;    // position beyond the play
  double gravity = 0;  // counts/s^2
  // Interpolation from `from` to `to`, which is reached `period` after `since`.
  double from = 0;
  double to = 0;
  hal::Instant since;
  hal::Duration period{};
  double effort = 0;      // counts/s^2 that the motor gives, what nothing moves included
  bool blocked = false;   // the motor cannot turn
  bool ignores = false;   // targets are not taken
  double ramp = 0;        // counts/s^2 of kStopping
  hal::Instant brake_at;  // when the brake has done what it was told last
  hal::Instant now;
};

class DriveMotion {
 public:
  // Fixed step of the integration: a tenth of the position loop's time constant at 25 Hz.
  static constexpr hal::Duration kStep = std::chrono::microseconds(500);

  DriveMotion(const MotionConfiguration& configuration, hal::Instant now);

  static constexpr double kLargestTorque = 3;

  [[nodiscard]] const MotionState& state() const { return s_; }
  [[nodiscard]] const MotionConfiguration& configuration() const { return configuration_; }
  [[nodiscard]] std::int32_t counts() const;
  [[nodiscard]] bool at_rest() const { return s_.velocity == 0; }
  // Whether a target given now would be followed.
  [[nodiscard]] bool follows() const {
    return s_.mode == Drivetrain::kFollows && !s_.ignores && s_.now >= s_.brake_at;
  }
  // Interpolated target less actual position, counts.
  [[nodiscard]] double following_error() const;

  // What the motor gives, as a share of its rated torque; at most kLargestTorque either way.
  [[nodiscard]] double torque() const;

  void follow();
  void stop(double ramp);
  // The torque goes. A drive that is at rest, and does it by itself (`orderly`), keeps it until the
  // brake has closed; else the joint coasts and falls until then.
  void release(bool orderly);
  void set_blocked(bool blocked) { s_.blocked = blocked; }
  void set_ignores(bool ignores) { s_.ignores = ignores; }
  // counts/s^2 that pull from now on: the arm has another pose. A limb that it pulls harder than
  // the friction of the motor rests on that side of the play.
  void set_gravity(double gravity) { s_.gravity = gravity; }
  // Moves the joint from outside, as a person does who leans on it.
  void push(double counts) { s_.position += counts; }
  // A new target, to be reached linearly `period` from now on (object 60C2h).
  void set_target(std::int32_t counts, hal::Duration period, hal::Instant now);
  // One step, unless it would end after `until`; whether there was one.
  bool step_before(hal::Instant until);

 private:
  [[nodiscard]] double reference(hal::Instant at) const;
  [[nodiscard]] double reference_velocity(hal::Instant at) const;
  void step();
  void step_braked(double dt);
  void step_following(double dt);
  void slow_down(double change);

  MotionConfiguration configuration_;
  MotionState s_;
};

}  // namespace armsig::simulated
