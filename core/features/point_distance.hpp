// SPDX-License-Identifier: MIT
// How far a point is from a motion fit, in its own noise and the prediction's: what the gate judges
// by.
#pragma once

#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

// Below this spread a point is the only one that determines some coefficient: nothing can
// contradict it.
inline constexpr double kNoSpread = 1e-6;

// The prediction's variance at `point` over the variance of the point.
[[nodiscard]] inline double leverage(const MotionRls& motion, const Vector3& regressors,
                                     const SweepPoint& point) {
  return motion.prediction_variance(regressors) / point.variance();
}

[[nodiscard]] inline Vector3 residual(const MotionStatistics& about,
                                      const MotionRls::Coefficients& fit, const SweepPoint& point,
                                      const Vector3& regressors) {
  return point.p_S - about.origin_S - fit.transpose() * regressors;
}

// r^T information r.
[[nodiscard]] inline double chi_square(const Vector3& r, const Matrix3& W) {
  const double squares = r[0] * r[0] * W(0, 0) + r[1] * r[1] * W(1, 1) + r[2] * r[2] * W(2, 2);
  const double mixed = r[0] * r[1] * W(0, 1) + r[0] * r[2] * W(0, 2) + r[1] * r[2] * W(1, 2);
  return squares + 2 * mixed;
}

// The same with (variance_factor * covariance + rounding)^-1 of the point, r its residual.
[[nodiscard]] inline double chi_square(const Vector3& r, const MotionRls::Coefficients& fit,
                                       double variance_factor, const SweepPoint& point) {
  Matrix3 covariance = variance_factor * point.covariance_m2;
  covariance.diagonal().array() += rounding_variance(point, fit.row(1).norm());
  return chi_square(r, information(covariance));
}

// A residual that was fitted is smaller than its noise, any other larger.
[[nodiscard]] inline double spread_of(double leverage, bool took_part) {
  return took_part ? 1 - leverage : 1 + leverage;
}

}  // namespace armsig::features
