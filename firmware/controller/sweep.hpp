// SPDX-License-Identifier: MIT
// The sweep of one joint: where its next point is, and whether it has enough.
#pragma once

#include <optional>

#include "core/features/sweep_estimator.hpp"
#include "firmware/controller/configuration.hpp"

namespace armsig::controller {

// What the sweep of `joint` spans by its plan; it goes on beyond where it is not accurate enough.
[[nodiscard]] JointLimits planned_arc(const Configuration& configuration, std::size_t joint);

class Sweep {
 public:
  Sweep(const Configuration& configuration, std::size_t joint);
  Sweep(const Sweep&) = delete;
  Sweep& operator=(const Sweep&) = delete;

  [[nodiscard]] JointLimits planned() const {
    return {first_, first_ + step_ * static_cast<double>(configuration_.sweeps.points - 1)};
  }
  // A bounded step of working out what the points show; false if nothing is left to do.
  bool step();
  // Reading of the next point, empty when the sweep is over: accurate enough, through all places
  // twice over, or out of points. Precondition: step() has returned false since the last point.
  [[nodiscard]] std::optional<double> next() const;
  // The point at next(), measured at the actual `reading`. Errors: those of SweepEstimator::add.
  Result<void> add(double reading, const Vector3& p_S, const Matrix3& covariance_m2);
  // The point at next() could not be measured.
  void skip() { ++done_; }
  // Nor can it be gone to, nor any that is farther out on that side.
  void turn_back();

  // Asks for a feature, whatever the number of points.
  void conclude();
  // What the points show; null: not asked, or not worked out yet.
  [[nodiscard]] const Judged<features::JointFeature>* feature() const {
    return estimation_ && !estimating_ ? &estimation_->result() : nullptr;
  }
  [[nodiscard]] std::size_t done() const { return done_; }
  // Predicted 1 sigma of the axis, from the points so far; empty: no estimate yet.
  [[nodiscard]] std::optional<double> axis_sigma_rad() const { return axis_sigma_rad_; }

 private:
  // How far the joint may go.
  [[nodiscard]] const JointLimits& reach() const;
  [[nodiscard]] bool is_accurate() const;

  const Configuration& configuration_;
  std::size_t joint_;
  features::SweepEstimator estimator_;
  std::optional<features::SweepEstimation> estimation_;  // of all points so far
  bool estimating_ = false;
  double first_ = 0;
  double step_ = 0;
  std::size_t above_ = 0;  // points that fit from first_ up to the upper limit
  std::size_t below_ = 0;  // further points that fit down to the lower limit
  std::size_t done_ = 0;
  std::optional<double> axis_sigma_rad_;
  std::optional<double> point_sigma_m_;
};

}  // namespace armsig::controller
