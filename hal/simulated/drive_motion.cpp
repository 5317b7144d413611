// SPDX-License-Identifier: MIT
#include "hal/simulated/drive_motion.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/pose.hpp"

namespace armsig::simulated {

DriveMotion::DriveMotion(const MotionConfiguration& configuration, hal::Instant now)
    : configuration_(configuration) {
  s_.now = now;
  s_.position = s_.from = s_.to = configuration.start;
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

void DriveMotion::enter(Drivetrain mode) {
  s_.mode = mode;
  if (mode == Drivetrain::kBraked) s_.velocity = 0;
  if (mode == Drivetrain::kFollows) {
    s_.from = s_.to = s_.position;
    s_.period = {};
  }
}

void DriveMotion::set_target(std::int32_t counts, hal::Duration period, hal::Instant now) {
  s_.from = reference(now);
  s_.to = counts;
  s_.since = now;
  s_.period = period;
}

bool DriveMotion::advance(hal::Instant until) {
  bool stepped = false;
  for (; s_.now + kStep <= until; stepped = true) {
    s_.now += kStep;
    step();
  }
  return stepped;
}

void DriveMotion::step() {
  const double dt = hal::seconds(kStep);
  if (s_.mode == Drivetrain::kBraked) return;
  if (s_.mode == Drivetrain::kStopping) {
    const double change = configuration_.stop_deceleration * dt;
    s_.velocity =
        std::fabs(s_.velocity) <= change ? 0 : s_.velocity - std::copysign(change, s_.velocity);
  } else {
    // a = w^2 (r - x) + 2 w (dr/dt - v), critically damped, then what the motor can do.
    const double w = 2 * kPi * configuration_.bandwidth_hz;
    const double wanted = w * w * (reference(s_.now) - s_.position) +
                          2 * w * (reference_velocity(s_.now) - s_.velocity);
    const double acceleration = std::clamp(wanted, -configuration_.largest_acceleration,
                                           configuration_.largest_acceleration);
    s_.velocity = std::clamp(s_.velocity + acceleration * dt, -configuration_.largest_speed,
                             configuration_.largest_speed);
    if (std::fabs(s_.velocity) < 1e-6) s_.velocity = 0;
  }
  if (s_.blocked) s_.velocity = 0;
  s_.position += s_.velocity * dt;
}

}  // namespace armsig::simulated
