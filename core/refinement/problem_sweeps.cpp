// SPDX-License-Identifier: MIT
// The reduced sweeps of the problem: residuals and linear rows.
#include <cmath>

#include "core/base/lanes.hpp"
#include "core/refinement/problem.hpp"

namespace armsig::refinement {

namespace {

// rows := R (x) I rows, for the columns before `columns`, of an upper triangular R.
void combine(const Matrix3& R, std::size_t columns, RowBlock<9>& block) {
  using V = Pack<double>;
  for (std::size_t j = 0; j < columns; j += Lanes<double>::kCount) {
    for (std::size_t i = 0; i < 3; ++i) {
      const V c = load<V>(&block.rows[i][j]);
      const V A = load<V>(&block.rows[3 + i][j]);
      const V B = load<V>(&block.rows[6 + i][j]);
      store(&block.rows[i][j], R(0, 0) * c + R(0, 1) * A + R(0, 2) * B);
      store(&block.rows[3 + i][j], R(1, 1) * A + R(1, 2) * B);
      store(&block.rows[6 + i][j], R(2, 2) * B);
    }
  }
}

}  // namespace

SweptPath Problem::path_of(const CompressedSweep& sweep) const {
  return swept_path(estimate_.signature, chain_, sweep.swept,
                    estimate_.signature.targets[sweep.target]);
}

Matrix3 Problem::sweep_residual(const CompressedSweep& sweep, const SweptPath& path) const {
  const double scaled = 1 + estimate_.scale;
  const Matrix3 Z_about_frame = sweep.Z - scaled * sweep.R.col(0) * path.X_SF.p.transpose();
  return Z_about_frame * path.X_SF.R - scaled * sweep.R * path.rows;
}

void Problem::add_sweep(const CompressedSweep& sweep, double weight) {
  const Layout& layout = estimate_.layout;
  const SweptJoint& swept = sweep.swept;
  const double scaled = 1 + estimate_.scale;
  const SweptPath path = path_of(sweep);
  PathDerivatives derivatives;
  path_derivatives(layout, estimate_.signature, chain_, swept, sweep.target, path, derivatives);
  const auto& joints = swept.middle.joints;
  for (std::size_t i = 0; i < estimate_.signature.targets[sweep.target].link; ++i) {
    if (i != swept.joint && joints[i].moved != 0) note(i, joints[i].moved, derivatives.radius[i]);
  }
  note(swept.joint, std::abs(joints[swept.joint].moved) + swept.half_length,
       derivatives.radius[swept.joint]);
  if (layout.scale != kNoColumn) {
    const Vector3 c = path.rows.row(0).transpose() + path.X_SF.R.transpose() * path.X_SF.p;
    derivatives.add(layout.scale, c / scaled, path.rows.row(1) / scaled, path.rows.row(2) / scaled);
  }
  const std::size_t right_hand_side = derivatives.columns.size();
  for (auto& row : derivatives.rows.rows) store(&row[right_hand_side], Pack<double>{});
  combine(weight * scaled * sweep.R, right_hand_side, derivatives.rows);
  const Matrix3 residual = weight * sweep_residual(sweep, path);
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      derivatives.rows.rows[3 * k + i][right_hand_side] =
          residual(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i));
    }
  }
  estimate_.information.absorb({derivatives.columns.data(), right_hand_side}, derivatives.rows);
}

}  // namespace armsig::refinement
