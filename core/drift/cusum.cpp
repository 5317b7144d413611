// SPDX-License-Identifier: MIT
#include "core/drift/cusum.hpp"

#include "core/base/check.hpp"

namespace armsig::drift {

double check_sigma(double pose_sigma_m, int poses) {
  ARMSIG_CHECK(poses >= 1);
  return pose_sigma_m / std::sqrt(static_cast<double>(poses));
}

double reference_value(double shift_m, double sigma_m) { return shift_m / (2 * sigma_m); }

Vector3 crosier(const Vector3& sum, const Vector3& z, double reference) {
  const Vector3 moved = sum + z;
  const double length = moved.norm();
  if (length <= reference) return Vector3::Zero();
  return moved * (1 - reference / length);
}

Result<State> after_check(const State& state, const Vector3& residual_m, const Settings& settings) {
  if (!residual_m.allFinite()) return std::unexpected(Error::kNotFinite);
  if (!(settings.sigma_m > 0) || !(settings.threshold > 0) || !(settings.reference >= 0)) {
    return std::unexpected(Error::kNotPositive);
  }
  State next = state;
  next.sum = crosier(state.sum, residual_m / settings.sigma_m, settings.reference);
  ++next.checks;
  next.since = next.sum.isZero(0) ? 0 : state.since + 1;
  next.named = state.named || next.sum.norm() > settings.threshold;
  return next;
}

}  // namespace armsig::drift
