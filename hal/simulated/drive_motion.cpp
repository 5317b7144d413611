// SPDX-License-Identifier: MIT
#include "hal/simulated/drive_motion.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/pose.hpp"

namespace armsig::simulated {

namespace {

// Of a position loop whose integrator stops at a few counts.
constexpr double kCompliance_s2 = 1e-6;

}  // namespace

MotionConfiguration honest_motion(double counts_per_radian) {
  return {.stop_deceleration = radians(180) * counts_per_radian,
          .gravity = 3 * counts_per_radian,
          .friction = 0.5 * counts_per_radian,
          .brake_delay = std::chrono::milliseconds(60),
          .brake_deceleration = 50 * counts_per_radian,
          .compliance_s2 = kCompliance_s2,
          .play = radians(0.003) * counts_per_radian,
          .rated_acceleration = 80 * counts_per_radian};
}

MotionConfiguration honest_slide(double counts_per_metre) {
  return {.stop_deceleration = 2 * counts_per_metre,
          .gravity = 0.1 * counts_per_metre,
          .friction = 0.5 * counts_per_metre,
          .brake_delay = std::chrono::milliseconds(60),
          .brake_deceleration = 20 * counts_per_metre,
          .compliance_s2 = kCompliance_s2,
          .play = 1e-5 * counts_per_metre,
          .rated_acceleration = 20 * counts_per_metre};
}

DriveMotion::DriveMotion(const MotionConfiguration& configuration, hal::Instant now)
    : configuration_(configuration) {
  s_.now = now;
  s_.brake_at = now;
  s_.gravity = configuration.gravity;
  s_.position = s_.joint = s_.from = s_.to = configuration.start;
}

std::int32_t DriveMotion::counts() const {
  return static_cast<std::int32_t>(
      std::lround(std::clamp(s_.position, -2147483648.0, 2147483647.0)));
}

double DriveMotion::reference(hal::Instant at) const {
  if (s_.period <= hal::Duration::zero()) return s_.to;
  const double part = hal::seconds(at - s_.since) / hal::seconds(s_.period);
  return s_.from + (s_.to - s_.from) * std::clamp(part, 0.0, 1.0);
}

double DriveMotion::reference_velocity(hal::Instant at) const {
  if (s_.period <= hal::Duration::zero() || at - s_.since > s_.period) return 0;
  return (s_.to - s_.from) / hal::seconds(s_.period);
}

double DriveMotion::following_error() const { return reference(s_.now) - s_.position; }

double DriveMotion::torque() const {
  if (configuration_.rated_acceleration <= 0) return 0;
  return std::clamp(s_.effort / configuration_.rated_acceleration, -kLargestTorque, kLargestTorque);
}

void DriveMotion::follow() {
  if (s_.mode == Drivetrain::kBraked) s_.brake_at = s_.now + configuration_.brake_delay;
  s_.mode = Drivetrain::kFollows;
  s_.from = s_.to = s_.position;
  s_.period = {};
}

void DriveMotion::stop(double ramp) {
  s_.mode = Drivetrain::kStopping;
  s_.ramp = ramp;
}

void DriveMotion::release(bool orderly) {
  if (s_.mode == Drivetrain::kBraked) return;
  // As slow as this a joint stands: less than ten counts while a brake closes.
  constexpr double kStands = 100;
  const bool holds = orderly && std::fabs(s_.velocity) <= kStands;
  s_.mode = Drivetrain::kBraked;
  s_.brake_at = holds ? s_.now : s_.now + configuration_.brake_delay;
  if (holds) s_.velocity = 0;
  if (s_.brake_at <= s_.now && configuration_.brake_deceleration == 0) s_.velocity = 0;
}

void DriveMotion::set_target(std::int32_t counts, hal::Duration period, hal::Instant now) {
  if (s_.ignores) return;
  s_.from = reference(now);
  s_.to = counts;
  s_.since = now;
  s_.period = period;
}

bool DriveMotion::step_before(hal::Instant until) {
  if (s_.now + kStep > until) return false;
  s_.now += kStep;
  step();
  return true;
}

void DriveMotion::slow_down(double change) {
  s_.velocity =
      std::fabs(s_.velocity) <= change ? 0 : s_.velocity - std::copysign(change, s_.velocity);
}

void DriveMotion::step_braked(double dt) {
  if (s_.now < s_.brake_at) {
    slow_down(configuration_.friction * dt);
    s_.velocity += s_.gravity * dt;
  } else if (configuration_.brake_deceleration > 0) {
    slow_down(configuration_.brake_deceleration * dt);
  } else {
    s_.velocity = 0;
  }
}

void DriveMotion::step_following(double dt) {
  if (s_.now < s_.brake_at) {  // still closed
    s_.velocity = 0;
    return;
  }
  // a = w^2 (r - x) + 2 w (dr/dt - v), critically damped, then what the motor can do.
  const double w = 2 * kPi * configuration_.bandwidth_hz;
  const double droop = configuration_.droop + configuration_.compliance_s2 * s_.gravity;
  const double wanted = w * w * (reference(s_.now) + droop - s_.position) +
                        2 * w * (reference_velocity(s_.now) - s_.velocity);
  const double acceleration =
      std::clamp(wanted, -configuration_.largest_acceleration, configuration_.largest_acceleration);
  s_.effort += acceleration;
  s_.velocity = std::clamp(s_.velocity + acceleration * dt, -configuration_.largest_speed,
                           configuration_.largest_speed);
  if (std::fabs(s_.velocity) < 1e-6) s_.velocity = 0;
}

void DriveMotion::step() {
  const double dt = hal::seconds(kStep);
  // The motor holds the limb, and what turns rubs.
  s_.effort = -s_.gravity;
  if (s_.velocity != 0) s_.effort += std::copysign(configuration_.friction, s_.velocity);
  if (s_.mode == Drivetrain::kBraked) s_.effort = 0;
  switch (s_.mode) {
    case Drivetrain::kBraked:
      step_braked(dt);
      break;
    case Drivetrain::kStopping:
      slow_down(s_.ramp * dt);
      break;
    case Drivetrain::kFollows:
      step_following(dt);
      break;
  }
  if (s_.blocked) s_.velocity = 0;
  s_.position += s_.velocity * dt;
  const double slack = configuration_.play / 2;
  if (std::fabs(s_.gravity) > configuration_.friction && slack > 0) {
    s_.joint = s_.position + std::copysign(slack, s_.gravity);
  } else {
    s_.joint = std::clamp(s_.joint, s_.position - slack, s_.position + slack);
  }
}

}  // namespace armsig::simulated
