// SPDX-License-Identifier: MIT
#include "firmware/controller/sweep.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/controller/measurement_log.hpp"

namespace armsig::controller {
namespace {

// Points never wait until the gate is full: the stack of a small controller has no room for the
// search that would follow.
static_assert(kMostSweepPoints < features::kGateCapacity);

// Before half of the plan nothing is judged: a lucky few points would end a sweep.
std::size_t least_points(const SweepPlan& plan) { return plan.points / 2; }

}  // namespace

JointLimits planned_arc(const Configuration& configuration, std::size_t joint) {
  const Sweep sweep(configuration, joint);
  return sweep.planned();
}

Sweep::Sweep(const Configuration& configuration, std::size_t joint)
    : configuration_(configuration),
      joint_(joint),
      estimator_({.type = configuration.drawing.joints[joint].type, .limits = {}}) {
  const SweepPlan& plan = configuration.sweeps;
  auto [lower, upper] = reach();
  const double least = lower;
  const double most = upper;
  const bool turns = configuration.drawing.joints[joint].type == JointType::kRevolute;
  const double arc_rad = arc_of(plan, joint);
  if (turns && arc_rad < upper - lower) {
    lower = std::clamp(plan.configuration[joint] - arc_rad / 2, lower, upper - arc_rad);
    upper = lower + arc_rad;
  }
  first_ = lower;
  step_ = (upper - lower) / static_cast<double>(plan.points - 1);
  // Rounding must not push the last point over a limit.
  constexpr double kSlack = 1e-9;
  above_ = static_cast<std::size_t>((most - lower) / step_ + kSlack) + 1;
  below_ = static_cast<std::size_t>((lower - least) / step_ + kSlack);
  if (turns) {
    // A full turn comes back to the first point.
    const auto turn = static_cast<std::size_t>(2 * kPi / step_);
    above_ = std::min(above_, std::max(plan.points, turn));
    below_ = std::min(below_, turn - std::min(turn, above_));
  }
}

const JointLimits& Sweep::reach() const {
  const auto& free = configuration_.sweeps.free;
  return free.empty() ? configuration_.drawing.limits[joint_] : free[joint_];
}

bool Sweep::is_accurate() const {
  const SweepPlan& plan = configuration_.sweeps;
  return done_ >= least_points(plan) && axis_sigma_rad_ &&
         *axis_sigma_rad_ <= plan.axis_sigma_rad && point_sigma_m_ &&
         *point_sigma_m_ <= plan.point_sigma_m;
}

std::optional<double> Sweep::next() const {
  const std::size_t once = above_ + below_;
  // On the way back, if it comes to that, the places in between.
  const std::size_t most = std::min(configuration_.sweeps.most_points, 2 * once - 1);
  if (done_ >= most || is_accurate()) return std::nullopt;
  double offset = 0;
  if (done_ < above_) {
    offset = static_cast<double>(done_);
  } else if (done_ < once) {
    offset = -static_cast<double>(done_ - above_ + 1);
  } else {
    const double back = static_cast<double>(done_ - once) + 0.5;
    offset =
        below_ > 0 ? back - static_cast<double>(below_) : static_cast<double>(above_ - 1) - back;
  }
  const JointLimits& limits = reach();
  return std::clamp(first_ + step_ * offset, limits.lower, limits.upper);
}

Result<void> Sweep::add(double reading, const Vector3& p_S, const Matrix3& covariance_m2) {
  ++done_;
  estimation_.reset();
  estimating_ = false;
  if (auto added = estimator_.add(reading, p_S, covariance_m2); !added) return added;
  if (done_ >= least_points(configuration_.sweeps)) conclude();
  return {};
}

void Sweep::turn_back() {
  if (done_ < above_) {
    above_ = done_;
  } else if (done_ < above_ + below_) {
    below_ = done_ - above_;
  } else {
    skip();
  }
}

void Sweep::conclude() {
  estimation_.emplace(estimator_);
  estimating_ = true;
}

bool Sweep::step() {
  if (!estimating_) return false;
  if (estimation_->step()) return true;
  estimating_ = false;
  axis_sigma_rad_.reset();
  const Judged<features::JointFeature>& estimate = estimation_->result();
  if (!estimate) return false;
  const auto& covariance = estimate->covariance;
  // Of the axis direction: the rotation vector's parts perpendicular to the axis.
  const Matrix3 across = Matrix3::Identity() - estimate->axis_S * estimate->axis_S.transpose();
  const Matrix3 turn = covariance.block<3, 3>(3, 3);
  const Matrix3 shift = covariance.block<3, 3>(0, 0);
  axis_sigma_rad_ = std::sqrt(std::max(0.0, (across * turn).trace()));
  point_sigma_m_ = std::sqrt(std::max(0.0, (across * shift).trace()));
  return false;
}

}  // namespace armsig::controller
