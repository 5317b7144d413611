// SPDX-License-Identifier: MIT
// From the statistics of the accepted points to the feature that the next stages read: the fit by
// their method, its covariance at the noise that the data show, and its residuals.
#pragma once

#include <optional>

#include "core/base/error.hpp"
#include "core/features/feature.hpp"
#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

// How noisy the points are.
struct NoiseLevel {
  double stated_sigma_m = 0;   // RMS over the points; 0 where nothing was stated
  double sigma_m = 0;          // that the covariances of the feature rest on
  double variance_factor = 1;  // by which the points' covariances are multiplied for it
  bool is_estimated = false;
  double misfit = 0;  // RMS residual over the stated sigma where it is significantly (99.99 %) more
                      // than 1; 0 otherwise
};

// Residuals of the unconstrained motion model. A stated sigma is taken at its word unless the
// residuals are significantly larger.
[[nodiscard]] NoiseLevel noise_level(const SweepStatistics& statistics, bool sigma_is_known);

// What the constraints of the encoder-referenced circle and line remove, as a diagnostic of the
// encoder: gear ratio, eccentricity, scale.
struct EncoderRatio {
  double ratio = 1;  // |A| / |B| (revolute), |u| (prismatic) of the unconstrained fit; ideally 1
  double sigma = 0;  // its 1 sigma, where the points' covariances are as given
};

// Precondition: statistics.motion has full rank and its motion is not zero.
[[nodiscard]] EncoderRatio encoder_ratio(const MotionStatistics& statistics);

// Fills in the feature, with all of its quality but `SweepQuality::rejected`; after a refusal it
// has no meaning. Refusals: kArcTooShort (the fit is singular), kNotConverged, kNotFinite.
[[nodiscard]] std::optional<Refusal> fit_feature(const SweepStatistics& statistics,
                                                 const NoiseLevel& noise, JointFeature& feature);

// How far the readings are from explaining a circle by its own constant radius: what imposing the
// circle cost, RMS over the points.
struct ReadingMisfit {
  double rms_rad = 0;     // as an angle of the joint
  double chi_square = 0;  // 2 degrees of freedom for an ideal encoder
};
// Precondition: `feature` is the encoder-referenced fit of a revolute joint to `statistics`.
[[nodiscard]] ReadingMisfit reading_misfit(const SweepStatistics& statistics,
                                           const NoiseLevel& noise, const JointFeature& feature);

// 1 sigma of the direction of the axis, in the direction where it is largest, radians.
[[nodiscard]] double axis_direction_sigma(const JointFeature& feature);

}  // namespace armsig::features
