// SPDX-License-Identifier: MIT
// The gate: which points of a sweep belong to the joint's motion (ALGORITHMS section 2, Gating).
//
// A point is judged by the chi-square of its innovation: measured minus predicted by the motion fit
// of the points accepted so far, over its own variance and the prediction's. Where the accepted
// points do not predict it yet (the start, or after a jump of the reading), points wait and are
// judged together: a least-median start over minimal subsets, then gating to a fixed point, so that
// neither outliers nor the order of the rows decide. Half of the points may be wrong.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/fixed_vector.hpp"
#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

inline constexpr std::size_t kGateCapacity = 128;

// Points that wait to be judged together.
using WaitingPoints = FixedVector<SweepPoint, kGateCapacity>;
using Verdicts = std::array<bool, kGateCapacity>;  // true: accepted

// 99.99 % quantile of chi-square with 3 degrees of freedom: of 10,000 good points the gate rejects
// one, which biases the covariance by 0.1 %.
inline constexpr double kGateChiSquare = 21.108;

// The scale and the limit of the gate, from the points accepted so far.
struct GateScale {
  double variance = 0;  // by which the points' covariances are multiplied; at least 1 where stated
  double limit = 0;     // of the innovation's chi-square
};
[[nodiscard]] GateScale gate_scale(const MotionStatistics& accepted, bool sigma_is_known);

// Whether the accepted points predict `point` well enough to judge it alone.
[[nodiscard]] bool predicts(const MotionStatistics& accepted, const SweepPoint& point);

// Judges `point` alone. Precondition: predicts(accepted, point).
[[nodiscard]] bool passes_gate(const MotionStatistics& accepted, bool sigma_is_known,
                               const SweepPoint& point);

// Judges the waiting points together, on top of those accepted before. `accepted` may be empty.
[[nodiscard]] Verdicts judge_together(const MotionStatistics& accepted, bool sigma_is_known,
                                      const WaitingPoints& waiting);

}  // namespace armsig::features
