// SPDX-License-Identifier: MIT
#include "hal/simulated/drive_profile.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::simulated {
namespace {

constexpr std::uint16_t kAtTarget = 1U << 10;
constexpr std::uint16_t kTargetTaken = 1U << 12;

}  // namespace

void DriveProfile::begin(const DriveMotion& motion) {
  target_ = reference_ = motion.state().position;
  speed_ = 0;
  offered_ = taken_ = false;
}

void DriveProfile::command(bool offered, double target, const DriveMotion& motion) {
  if (offered && !offered_ && motion.follows()) {
    target_ = target;
    taken_ = true;
  }
  if (!offered) taken_ = false;
  // An edge before the brake has opened is not lost.
  offered_ = offered && taken_;
}

void DriveProfile::step(const ProfileObjects& objects, DriveMotion& motion) {
  const double dt = hal::seconds(DriveMotion::kStep);
  const double way = target_ - reference_;
  // As fast as it can still be stopped at the target.
  const double braking = objects.deceleration * dt;
  const double fastest = std::min(
      objects.speed,
      std::sqrt(2 * objects.deceleration * std::fabs(way) + braking * braking / 4) - braking / 2);
  const double wanted = std::copysign(std::max(fastest, 0.0), way);
  const bool slows = std::fabs(wanted) < std::fabs(speed_) || wanted * speed_ < 0;
  const double change = (slows ? objects.deceleration : objects.acceleration) * dt;
  speed_ += std::clamp(wanted - speed_, -change, change);
  reference_ += speed_ * dt;
  if (std::fabs(way) < 0.5 && std::fabs(speed_) <= 2 * change) {
    reference_ = target_;
    speed_ = 0;
  }
  motion.set_target(static_cast<std::int32_t>(std::lround(reference_)), DriveMotion::kStep,
                    motion.state().now);
}

std::uint16_t DriveProfile::status_bits(const DriveMotion& motion) const {
  const bool reached = reference_ == target_ && motion.at_rest();
  return static_cast<std::uint16_t>((reached ? kAtTarget : 0U) | (taken_ ? kTargetTaken : 0U));
}

}  // namespace armsig::simulated
