// SPDX-License-Identifier: MIT
#include "core/features/gate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/features/point_distance.hpp"
#include "core/numerics/quantiles.hpp"

namespace armsig::features {
namespace {

// A point is judged alone once the prediction adds less than this to its variance.
constexpr double kMostPredictionVariance = 0.5;

// The limit where the variance itself is estimated from so many residuals; infinite where there is
// too little to judge by.
double estimated_limit(double freedom) {
  if (freedom < 1) return std::numeric_limits<double>::infinity();
  return numerics::chi_square_quantile(3, numerics::kNormal9999, freedom);
}

}  // namespace

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
  const Vector3& r = trial.innovation().residual;
  const double spread = spread_of(trial.innovation().leverage, false);
  // The scale of a stated sigma is never below 1, and rounding only adds to it: nearly every point
  // is seen to pass without either.
  if (sigma_is_known &&
      chi_square(r, trial.has_first_covariance
                        ? accepted.first_information
                        : information(point.covariance_m2)) <= kGateChiSquare * spread)
    return true;
  const GateScale scale = gate_scale(accepted, sigma_is_known);
  return chi_square(r, accepted.motion.solve(), scale.variance, point) <= scale.limit * spread;
}

bool is_consistent(const MotionStatistics& accepted) {
  const double freedom = accepted.motion_freedom();
  return accepted.motion.rank() == motion_unknowns(accepted.type) && freedom >= 1 &&
         accepted.motion_chi_square() <=
             numerics::chi_square_quantile(freedom, numerics::kNormal9999);
}

bool Review::confirms(const SweepPoint& point) const {
  const Vector3 x = accepted_.regressors(point);
  const double spread = spread_of(leverage(accepted_.motion, x, point), true);
  if (spread < kNoSpread) return true;
  const Vector3 r = residual(accepted_, fit_, point, x);
  // As in passes_gate().
  if (chi_square(r, accepted_.has_one_covariance()
                        ? accepted_.first_information
                        : information(point.covariance_m2)) <= kGateChiSquare * spread)
    return true;
  const GateScale scale = gate_scale(accepted_, true);
  return chi_square(r, fit_, scale.variance, point) <= scale.limit * spread;
}

}  // namespace armsig::features
