// SPDX-License-Identifier: MIT
#include "core/features/gate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numerics/quantiles.hpp"

namespace armsig::features {
namespace {

// A point is judged alone once the prediction adds less than this to its variance.
constexpr double kMostPredictionVariance = 0.5;

// The limit where the variance itself is estimated from so many residuals; infinite where there is
// too little to judge by.
double estimated_limit(double freedom) {
  if (freedom < 1) return std::numeric_limits<double>::infinity();
  return numerics::chi_square_quantile(3, numerics::kReadingRefused, freedom);
}

// A residual that was fitted is smaller than its noise, any other larger: by `spread`.
bool passes(const MotionStatistics& accepted, bool sigma_is_known, const SweepPoint& point,
            const Trial& trial, double spread) {
  const Vector3& r = trial.innovation().residual;
  // The scale of a stated sigma is never below 1, and rounding only adds to it: nearly every point
  // is seen to pass without either.
  const Information information =
      trial.has_first_covariance ? accepted.first_information : Information(point.covariance_m2);
  if (sigma_is_known && information.chi_square(r) <= kGateChiSquare * spread) return true;
  return gate_scale(accepted, sigma_is_known).allows(r, spread, point, accepted.motion.solve());
}

}  // namespace

bool GateScale::allows(const Vector3& residual, double spread, const SweepPoint& point,
                       const MotionRls::Coefficients& fit) const {
  Matrix3 covariance = variance * point.covariance_m2;
  covariance.diagonal().array() += rounding_variance(point, fit.row(1).norm());
  return Information(covariance).chi_square(residual) <= limit * spread;
}

GateScale gate_scale(const MotionStatistics& accepted, bool sigma_is_known) {
  const double freedom = accepted.motion_freedom();
  const double variance = freedom < 1 ? 0 : accepted.motion_chi_square() / freedom;
  // A stated sigma may be too small, by a factor that the residuals show; it is never made smaller.
  if (sigma_is_known) return {std::max(variance, 1.0), kGateChiSquare};
  // Where nothing was stated, a systematic error of drive or sensor can't be told from noise by its
  // size, and real ones reach five or six sigmas of the rest; outliers by a detour of the sound are
  // far beyond twice the distance.
  return {variance, 4 * estimated_limit(freedom)};
}

bool is_close(const Trial& trial) { return trial.innovation().leverage < kMostPredictionVariance; }

bool passes_gate(const MotionStatistics& accepted, bool sigma_is_known, const SweepPoint& point,
                 const Trial& trial) {
  return passes(accepted, sigma_is_known, point, trial, 1 + trial.innovation().leverage);
}

bool exceeds_noise(double chi_square, double freedom) {
  // Chi-square leans to the right, so that its quantile lies above that of the normal law with the
  // same mean and variance: mostly that is enough to know.
  constexpr double kNormal9999 = 3.7190165;
  return chi_square > freedom + kNormal9999 * std::sqrt(2 * freedom) &&
         chi_square > numerics::chi_square_quantile(freedom, numerics::kReadingRefused);
}

bool is_consistent(const MotionStatistics& accepted) {
  const double freedom = accepted.motion_freedom();
  if (accepted.motion.rank() != motion_unknowns(accepted.type) || freedom < 1) return false;
  return !exceeds_noise(accepted.motion_chi_square(), freedom);
}

bool is_confirmed(const MotionStatistics& accepted, const SweepPoint& point) {
  const Trial trial = accepted.tried(point);
  const double spread = 1 - trial.innovation().leverage;
  return spread < kNoSpread || passes(accepted, true, point, trial, spread);
}

}  // namespace armsig::features
