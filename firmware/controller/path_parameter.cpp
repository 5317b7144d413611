// SPDX-License-Identifier: MIT
#include "firmware/controller/path_parameter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace armsig::controller {
namespace {

// A path along which no joint moves has no share: its bounds are large, and numbers.
constexpr double kLeastShare = 1e-9;

// Of a number that is not negative, in two instructions: floor() would be the only one of an image.
double whole(double number) {
  constexpr double kMost = 1e9;
  return static_cast<std::int32_t>(std::min(number, kMost));
}

// The largest decrease b of a step v from which the steps can still come to rest, each decrease
// smaller than the one before by `jerk` at most: b + (b - jerk) + (b - 2 jerk) + ... = v.
double decrease_to_rest(double v, double jerk) {
  const double further = whole((std::sqrt(1 + 8 * v / jerk) - 1) / 2);
  if (further == 0) return v;
  return v / (further + 1) + jerk * further / 2;
}

}  // namespace

std::size_t path_part(double s) {
  const double part = std::clamp(s, 0.0, 1.0) * static_cast<double>(kPathParts);
  return std::min(static_cast<std::size_t>(part), kPathParts - 1);
}

void PathShares::add(double s_from, double s_to, double slope, double curvature, double speed,
                     double acceleration) {
  constexpr double kRoundedUp = 1 + 1e-6;
  const auto slope_share = static_cast<float>(kRoundedUp * slope / acceleration);
  const auto curvature_share = static_cast<float>(kRoundedUp * curvature / acceleration);
  for (std::size_t i = path_part(s_from); i <= path_part(s_to); ++i) {
    parts[i].slope = std::max(parts[i].slope, slope_share);
    parts[i].curvature = std::max(parts[i].curvature, curvature_share);
  }
  full_speed = std::max(full_speed, slope * speed / (acceleration * acceleration));
}

double BrakingLimits::braking_in(std::size_t part, double speed) const {
  const double slope = std::max(static_cast<double>(shares.parts[part].slope), kLeastShare);
  const double left = 1 - static_cast<double>(shares.parts[part].curvature) * speed * speed;
  return std::max(planned, left / slope);
}

BrakingLimits braking_limits(const PathShares& shares, double duration_s) {
  const double cubed = duration_s * duration_s * duration_s;
  return {.shares = shares,
          .planned = kPeakAcceleration / (duration_s * duration_s),
          .jerk = std::max(kPeakJerk / cubed,
                           kJerkOfFullSpeed / std::max(shares.full_speed, kLeastShare))};
}

void PathParameter::begin(double duration_s, double period_s) {
  *this = {};
  duration_s_ = left_s_ = duration_s;
  period_s_ = period_s;
  at_rest_ = false;
}

double PathParameter::advance(const BrakingLimits& limits) {
  left_s_ = std::max(0.0, left_s_ - period_s_);
  if (braking_) {
    advance_braking(limits);
    return s_;
  }
  const double s = minimum_jerk(1 - left_s_ / duration_s_);
  growth_ = (s - s_) - step_;
  step_ = s - s_;
  s_ = s;
  at_rest_ = left_s_ == 0;
  return s_;
}

// Per tick, where the last step began and where the next ones lead, should they not become smaller.
// The jerk must suffice to come down to what is left there, which it then always does: each tick
// brings a part nearer by one tick at most.
double PathParameter::most_braking(const BrakingLimits& limits) const {
  const double speed = step_ / period_s_;
  double most = std::numeric_limits<double>::infinity();
  for (std::size_t part = path_part(s_ - step_); part < kPathParts; ++part) {
    const double begins = static_cast<double>(part) / static_cast<double>(kPathParts);
    const double ticks = begins > s_ ? whole((begins - s_) / step_) : 0;
    const double there = limits.braking_in(part, speed) + limits.jerk * period_s_ * ticks;
    most = std::min(most, there * period_s_ * period_s_);
  }
  return most;
}

// Bounds of steps and of their changes, a tick each. The second difference of q(s) is at most
// slope |growth| + curvature step^2, as the steps fall.
void PathParameter::advance_braking(const BrakingLimits& limits) {
  const double jerk = limits.jerk * period_s_ * period_s_ * period_s_;
  const double decrease =
      std::min({decrease_to_rest(step_, jerk), most_braking(limits), jerk - growth_});
  growth_ = -decrease;
  step_ = std::max(0.0, step_ - decrease);
  s_ = std::min(1.0, s_ + step_);
  at_rest_ = step_ == 0;
}

}  // namespace armsig::controller
