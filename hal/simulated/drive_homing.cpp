// SPDX-License-Identifier: MIT
#include "hal/simulated/drive_homing.hpp"

#include <cmath>

namespace armsig::simulated {
namespace {

constexpr std::int8_t kHereOld = 35;  // the number of the same method before 2008
constexpr std::int8_t kHere = 37;
constexpr std::uint16_t kReached = 1U << 10;
constexpr std::uint16_t kAttained = 1U << 12;
constexpr std::uint16_t kError = 1U << 13;

}  // namespace

void DriveHoming::command(bool search, const HomingObjects& objects, DriveMotion& motion) {
  if (search && !commanded_) {
    stage_ = Stage::kFast;
    reference_ = motion.state().position;
    if (objects.method == 0) stage_ = Stage::kFailed;  // none is chosen
  } else if (!search && commanded_ && (stage_ == Stage::kFast || stage_ == Stage::kSlow)) {
    stage_ = Stage::kIdle;
  }
  commanded_ = search;
}

std::optional<double> DriveHoming::step(const HomingObjects& objects,
                                        const std::optional<double>& edge, DriveMotion& motion) {
  if (stage_ != Stage::kFast && stage_ != Stage::kSlow) return std::nullopt;
  if (objects.method == kHere || objects.method == kHereOld) {
    stage_ = Stage::kFound;
    return motion.state().position;
  }
  if (!edge) {
    stage_ = Stage::kFailed;
    return std::nullopt;
  }
  const double speed = stage_ == Stage::kFast ? objects.fast : objects.slow;
  const double way = *edge - motion.state().position;
  const double travel = speed * hal::seconds(DriveMotion::kStep);
  reference_ += std::copysign(travel, way);
  motion.set_target(static_cast<std::int32_t>(std::lround(reference_)), DriveMotion::kStep,
                    motion.state().now);
  // The edge is passed where the motor is within a step of it.
  if (std::fabs(way) > travel) return std::nullopt;
  if (stage_ == Stage::kFast) {
    stage_ = Stage::kSlow;
    reference_ = motion.state().position;
    return std::nullopt;
  }
  stage_ = Stage::kFound;
  return edge;
}

std::uint16_t DriveHoming::status_bits(const DriveMotion& motion) const {
  if (stage_ == Stage::kFailed) return motion.at_rest() ? kError | kReached : kError;
  if (stage_ == Stage::kFound) return motion.at_rest() ? kAttained | kReached : kAttained;
  return stage_ == Stage::kIdle && motion.at_rest() ? kReached : 0;
}

}  // namespace armsig::simulated
