// SPDX-License-Identifier: MIT
// A sweep of one joint, reduced exactly to three rows.
//
// While one joint moves and all others rest, a target follows a path of three regressors (two for a
// prismatic joint; swept_path.hpp) however long the sweep. Its rows reduce by their own triangular
// factor (section 2 of ALGORITHMS) and nothing about the axis lines is lost:
//   R [c; A; B] = Z.
#pragma once

#include <span>

#include "core/refinement/observation.hpp"
#include "core/refinement/swept_path.hpp"

namespace armsig::refinement {

struct CompressedSweep {
  std::size_t first_row = 0;  // in the log
  std::size_t row_count = 0;
  std::size_t used = 0;  // rows that count, by their weights
  std::size_t target = 0;
  bool sigma_stated = false;
  SweptJoint swept;
  Matrix3 R = Matrix3::Zero();  // upper triangular; 1/m, or 1 where no sigma was stated
  Matrix3 Z = Matrix3::Zero();  // one column a coordinate
  double residual_squares = 0;  // what no circle or line can explain, in the units of R squared
};

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

// Residual lengths [m] of rows of the sweep from the path with the coefficients c, A, B in the rows
// of `path_S`, into the outcomes at the same index.
void sweep_residuals(std::span<const Observation> rows, const CompressedSweep& sweep,
                     const Chain& chain, const Matrix3& path_S, std::span<RowOutcome> outcomes);

}  // namespace armsig::refinement
