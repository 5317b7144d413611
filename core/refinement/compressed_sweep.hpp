// SPDX-License-Identifier: MIT
// A sweep of one joint, reduced exactly to three rows.
//
// While one joint moves and all others rest, a target follows p = c + A cos d + B sin d (revolute)
// or p = c + u d (prismatic), d the joint's motion: three or two regressors however long the sweep.
// Its rows reduce by their own triangular factor (section 2 of ALGORITHMS) and nothing about the
// axis lines is lost. The model's own c, A, B are linear in the model's positions at any three
// values of d, so the reduced sweep is kept as three weighted sums of three nodes:
//   W [p(d_1); p(d_2); p(d_3)] = Z.
#pragma once

#include <span>

#include "core/refinement/chain.hpp"
#include "core/refinement/observation.hpp"

namespace armsig::refinement {

struct CompressedSweep {
  std::size_t first_row = 0;  // in the log
  std::size_t row_count = 0;
  std::size_t used = 0;  // rows that count, by their weights
  std::size_t target = 0;
  bool sigma_stated = false;
  std::size_t joint = 0;  // index of the swept joint
  bool revolute = true;
  double middle = 0;                     // of the swept joint's motion
  double half_length = 0;                // of it
  std::array<double, 3> nodes{};         // values of it
  Matrix3 from_nodes = Matrix3::Zero();  // [c; A; B] = from_nodes [p(d_1); p(d_2); p(d_3)]
  Matrix3 W = Matrix3::Zero();           // 1/m; 1 where no sigma was stated
  Matrix3 Z = Matrix3::Zero();           // one column a coordinate
  double residual_squares = 0;  // what no circle or line can explain, in the units of W squared
};

// [1, cos d, sin d] or [1, d, 0] of one row of the sweep, d about its middle: with the coefficients
// from_nodes [p(d_1); ...] the position of its target, without the chain.
[[nodiscard]] Vector3 sweep_regressors(const CompressedSweep& sweep, const Chain& chain,
                                       const JointVector& readings);

// The number of rows from `first` on that belong to one sweep that can be reduced: same target,
// only the joint named by `sweep` moves, positions, sigma stated for all or for none, and no other
// joint's reading hangs on the swept one. 0 when the row at `first` begins none.
[[nodiscard]] std::size_t sweep_length(std::span<const Observation> log, std::size_t first,
                                       const ReadingModel& readings);

// Reduces rows [first, first + count). Gross outliers are weighted down or out first, by a robust
// fit of the same three regressors, and marked in `outcomes`. The motions are taken from `chain`,
// so the readings' corrections of the swept joint must not change afterwards; every other parameter
// may. False, and nothing changed, when the rows do not determine their regressors (fewer than 4,
// or too small a motion) or hardly follow them: such rows go to the filter one by one.
[[nodiscard]] bool compress_sweep(std::span<const Observation> log, std::size_t first,
                                  std::size_t count, const Chain& chain, JointType type,
                                  std::span<RowOutcome> outcomes, CompressedSweep& sweep);

}  // namespace armsig::refinement
