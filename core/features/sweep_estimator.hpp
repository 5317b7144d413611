// SPDX-License-Identifier: MIT
// From the points of one sweep to the feature of one joint: the feature identification of section
// 3.2.1, one point at a time, in constant memory.
#pragma once

#include <cstddef>
#include <optional>

#include "core/base/arm.hpp"
#include "core/base/error.hpp"
#include "core/features/feature.hpp"
#include "core/features/settling.hpp"

namespace armsig::features {

// When a sweep says too little to be used.
struct SweepLimits {
  // Accepted points. Three determine the motion of a revolute joint, two that of a prismatic one,
  // and leave nothing to judge it by.
  std::size_t least_points = 4;
  std::size_t least_points_prismatic = 3;
  // Revolute only.
  double least_arc_rad = kPi / 36;
  // 1 sigma of the direction of the axis: 3 cm at 1 m.
  double greatest_axis_sigma_rad = 0.03;
  // Radius of the circle, or travel of a prismatic target, over 1 sigma of a point.
  double least_radius_sigmas = 10;
  // RMS residual over the sigma stated: a sigma stated three times too small still passes.
  double greatest_misfit = 6;
  // Of a revolute joint besides: what a sound encoder and gear err by within a turn (RMS), as seen
  // at the radius of the circle, where no sensor is as coarse.
  double greatest_reading_error_rad = 5e-4;
  // RMS residual over radius or travel, where no sigma is stated.
  double greatest_unstated_sigma = 0.02;
  // Fraction of the points rejected.
  double greatest_rejected = 0.5;
  // RMS angle by which the readings fail to explain an encoder-referenced circle.
  double greatest_reading_misfit_rad = 0.01;
  // |encoder_ratio - 1|, beyond 5 of its sigmas.
  double greatest_encoder_error = 0.2;
};

struct SweepConfig {
  JointType type = JointType::kRevolute;
  SweepLimits limits = {};
  Method method = Method::kEncoder;  // of estimate(); the paper's keeps more of each point
};

// Readings nearer than this are one reading, radians or metres.
inline constexpr double kSameReading = 1e-9;

// Where the noise is stated and the first points agree with it, each one is judged and taken in as
// it comes, at the same cost. Where not, the first 128 wait, and the last of them costs as much as
// hundreds: they are judged together (core/features/judging.hpp).
class SweepEstimator {
 public:
  explicit SweepEstimator(const SweepConfig& config);

  // covariance_m2: of the point; the zero matrix where unknown. The first point decides: if its
  // covariance is unknown, sigma is estimated from the residuals of the whole sweep; if it is
  // known, a later point without one takes that of the point before. Errors: kNotFinite; kSingular
  // (a covariance that is neither zero nor positive definite). Such a point is not taken.
  Result<void> add(double reading, const Vector3& p_S, const Matrix3& covariance_m2);

  [[nodiscard]] std::size_t count() const { return state_.count; }
  [[nodiscard]] const SweepState& state() const { return state_; }

  // The feature that all points so far show. May be called at any time, as often as wanted.
  // Refusals (found, needed):
  //   kTooFewPoints      points or distinct readings; the least number
  //   kJointDidNotMove   0, all readings being the same; the least arc
  //   kCoincidentPoints  how far the target moved; 10 sigma of a point
  //   kTooManyOutliers   points accepted; the least number
  //   kNotACircle        RMS residual, or misfit of the readings, the greatest; or the encoder
  //                      ratio, 1
  //   kArcTooShort       arc; the least arc, as far as the noise or the limits ask for it
  //   kRadiusTooSmall    radius; the least radius
  //   kNotFinite         0, 0: numbers too large to compute with
  //   kNotConverged      0, 0: the constrained fit used up its iterations
  [[nodiscard]] Judged<JointFeature> estimate() const;

 private:
  friend class SweepEstimation;

  void take_while_waiting(const SweepPoint& point);
  [[nodiscard]] bool agrees(const SweepPoint& point);
  [[nodiscard]] bool two_still_agree() const;
  void settle();

  SweepConfig config_;
  SweepState state_;
};

// SweepEstimator::estimate(), a bounded step at a time. The estimator must outlive it and take no
// point meanwhile.
class SweepEstimation {
 public:
  explicit SweepEstimation(const SweepEstimator& estimator);

  // False if nothing is left to do.
  bool step();
  // Precondition: step() has returned false.
  [[nodiscard]] const Judged<JointFeature>& result() const { return *result_; }

 private:
  void fit();
  // The feature, or why there is none.
  [[nodiscard]] std::optional<Refusal> fit_accepted(JointFeature& feature) const;

  const SweepConfig& config_;
  const SweepState& state_;
  std::optional<Settling> settling_;  // empty until it may begin
  std::optional<Judged<JointFeature>> result_;
};

}  // namespace armsig::features
