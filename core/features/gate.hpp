// SPDX-License-Identifier: MIT
// The gate: which points of a sweep belong to the joint's motion (docs/model.md, section 2).
//
// A point is judged by the chi-square of its innovation: measured minus predicted by the motion fit
// of the points accepted so far, over its own variance and the prediction's. Where the accepted
// points do not predict it yet (the start, or after a jump of the reading), points wait and are
// judged together: a least-median start over minimal subsets, then gating to a fixed point, so that
// neither outliers nor the order of the rows decide. Half of the points may be wrong.
//
// That search costs as much as hundreds of points. Where the noise is stated and the first points
// agree with it, those that wait are taken in as they come, each judged by those before it, and all
// examined again, by all, when somebody asks: as long as every one passes, they are such a fixed
// point already and nothing has to be searched.
#pragma once

#include "core/features/sweep_statistics.hpp"
#include "core/numerics/quantiles.hpp"

namespace armsig::features {

// Of 3 degrees of freedom: of 10,000 good points the gate rejects one, which biases the covariance
// by 0.1 %.
inline constexpr double kGateChiSquare = numerics::kChiSquare9999[2];

// The scale and the limit of the gate, from the points accepted so far.
struct GateScale {
  double variance = 0;  // by which the points' covariances are multiplied; at least 1 where stated
  double limit = 0;     // of the innovation's chi-square

  // Whether `residual`, of `spread` times the variance of the point, may be of the motion `fit`;
  // the point besides has the rounding of its numbers.
  [[nodiscard]] bool allows(const Vector3& residual, double spread, const SweepPoint& point,
                            const MotionRls::Coefficients& fit) const;
};
[[nodiscard]] GateScale gate_scale(const MotionStatistics& accepted, bool sigma_is_known);

// Below this spread a point is the only one that determines some coefficient: nothing can
// contradict it.
inline constexpr double kNoSpread = 1e-6;

// Whether those accepted before it predict a point well enough to judge it alone, and for good.
[[nodiscard]] bool is_close(const Trial& trial);

// Judges `point` alone. Precondition: `trial` is of it by `accepted`, with a finite leverage.
[[nodiscard]] bool passes_gate(const MotionStatistics& accepted, bool sigma_is_known,
                               const SweepPoint& point, const Trial& trial);

// Whether a sum of squares of `freedom` > 0 degrees, in units of the noise, is more than noise
// shows in 9,999 of 10,000 sweeps.
[[nodiscard]] bool exceeds_noise(double chi_square, double freedom);

// Whether as many points as these, all accepted unseen, agree with each other and with their stated
// covariances (chi-square of all residuals, 99.99 %).
[[nodiscard]] bool is_consistent(const MotionStatistics& accepted);

// The verdict of all that are accepted on `point`, which is one of them, of a stated sigma.
[[nodiscard]] bool is_confirmed(const MotionStatistics& accepted, const SweepPoint& point);

}  // namespace armsig::features
