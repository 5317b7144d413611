// SPDX-License-Identifier: MIT
#include "core/kinematics/verdict.hpp"

#include <cmath>

namespace armsig::kinematics {
namespace {

// Whether the columns of R are right-handed, perpendicular unit vectors.
bool is_rotation(const Matrix3& R) {
  const Vector3 x = R.col(0);
  const Vector3 y = R.col(1);
  const Vector3 off(x.squaredNorm() - 1, y.squaredNorm() - 1, x.dot(y));
  return (x.cross(y) - R.col(2)).squaredNorm() + off.squaredNorm() <=
         kRotationDefect * kRotationDefect;
}

}  // namespace

std::optional<Error> refusal(const Pose& X_0n, const JointVector& seed,
                             const InverseOptions& options) {
  bool finite = X_0n.R.allFinite() && X_0n.p.allFinite() && options.p_nP.allFinite() &&
                !std::isnan(options.degraded_below) && !std::isnan(options.position_tolerance_m) &&
                !std::isnan(options.rotation_tolerance_rad);
  bool in_range = options.p_nP.cwiseAbs().maxCoeff() <= kFarthest && options.max_iterations >= 1 &&
                  options.position_tolerance_m >= 0 && options.rotation_tolerance_rad >= 0;
  for (const double reading : seed) {
    finite = finite && std::isfinite(reading);
    in_range = in_range && std::abs(reading) <= kFarthest;
  }
  for (const double step : options.max_step) {
    finite = finite && !std::isnan(step);
    in_range = in_range && step >= 0;
  }
  if (!finite) return Error::kNotFinite;
  if (!is_rotation(X_0n.R)) return Error::kNotARotation;
  if (!(X_0n.p.cwiseAbs().maxCoeff() <= kFarthest)) return Error::kOutOfReach;
  if (!in_range) return Error::kOutOfRange;
  return std::nullopt;
}

}  // namespace armsig::kinematics
