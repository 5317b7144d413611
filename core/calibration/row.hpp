// SPDX-License-Identifier: MIT
// One measured row as the filter wants it: residual and derivatives, divided by its sigma.
#pragma once

#include "core/calibration/refined.hpp"
#include "core/numerics/robust.hpp"

namespace armsig::calibration {

// The measured range that the estimate predicts for a target at p_S, and its derivative by p_S.
struct PredictedRange {
  double value = 0;
  Vector3 gradient = Vector3::Zero();
};
[[nodiscard]] PredictedRange predict_range(const Refined& estimate, const Receivers& receivers,
                                           const Observation& row, const Vector3& p_S);

// Length of (measured - predicted) for a target at p_S [m].
[[nodiscard]] double residual_length(const Refined& estimate, const Receivers& receivers,
                                     const Observation& row, const Vector3& p_S);

// Whether every number of the row that counts is finite.
[[nodiscard]] bool is_finite(const Observation& row);

// The robust thresholds of a row: three scalars or one.
[[nodiscard]] inline const numerics::RobustThresholds& thresholds(const Observation& row) {
  return row.kind == ObservationKind::kPosition ? numerics::kThresholds3 : numerics::kThresholds1;
}

// What rows are linearised with.
struct Linearised {
  JointMotion motion;
  PointJacobian jacobian;
};

// The three rows of the derivatives of target `target`'s position at `readings` by every unknown,
// and what they were linearised with.
[[nodiscard]] Linearised position_rows(const Refined& estimate, const PoeChain& chain,
                                       const JointVector& readings, std::size_t target,
                                       RowBlock<3>& rows);

// Linearises `row` at the estimate and takes it into `factor`; `weight` is the inverse of its sigma
// [1/m]. Returns what it was linearised with.
Linearised absorb_row(const Refined& estimate, const Receivers& receivers, const PoeChain& chain,
                      const Observation& row, double weight, SquareRootFactor& factor);

}  // namespace armsig::calibration
