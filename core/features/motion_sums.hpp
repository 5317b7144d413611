// SPDX-License-Identifier: MIT
// Many points of a revolute sweep compressed at once, at a fraction of the cost of one at a time.
//
// Sums of products lose half of the digits of what is measured, except where it is nothing but
// noise: so the points are taken about the motion through three of them, and only the products of
// those small distances are summed. What is left to the sums' conditioning is the regressors', at
// least kLeastPivot, and the misfit loses no digit that the noise has.
#pragma once

#include <span>

#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

struct MotionSums {
  MotionRls::Kept rows;
  MotionRls::KeptProducts residual_products;
  double lowest_reading = 0;
  double highest_reading = 0;
};

// The regressors are about `origin_reading`, the positions about `origin_S`; every point must have
// the covariance `covariance_m2` and weighs one over its mean variance per axis. False, and nothing
// said, where a point has another one, where a reading is beyond the reach of the polynomials of
// the sine, or where three of the points do not span the motion well.
// Precondition: at least three points, a multiple of the processor's lanes.
[[nodiscard]] bool motion_sums(std::span<const SweepPoint> points, double origin_reading,
                               const Vector3& origin_S, const Matrix3& covariance_m2,
                               MotionSums& result);

}  // namespace armsig::features
