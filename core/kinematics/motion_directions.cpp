// SPDX-License-Identifier: MIT
#include "core/kinematics/motion_directions.hpp"

#include "core/numerics/cholesky.hpp"

namespace armsig::kinematics {

// By inverse iteration.
Joints weakest_direction(const Jacobian& J, Eigen::Index n) {
  Joints direction = Joints::Zero();
  direction.head(n).setOnes();
  Square normal = J.transpose().lazyProduct(J);
  normal.diagonal().array() += 1e-9 * J.squaredNorm();
  if (!numerics::factor_positive(normal, n)) return Joints::Zero();
  for (int k = 0; k < 3; ++k) {
    numerics::solve_lower(normal, direction, n);
    numerics::solve_lower_transposed(normal, direction, n);
    direction /= direction.cwiseAbs().maxCoeff();
  }
  return direction;
}

Joints self_motion(const Jacobian& J, const Joints& v) {
  Square normal = Square::Zero();
  normal.topLeftCorner<6, 6>() = J.lazyProduct(J.transpose());
  normal.diagonal().array() += 1e-12 * J.squaredNorm();
  Joints x = Joints::Zero();
  x.head<6>() = J.lazyProduct(v);
  if (!numerics::solve_positive(normal, x, 6)) return Joints::Zero();
  return v - J.transpose().lazyProduct(x.head<6>());
}

}  // namespace armsig::kinematics
