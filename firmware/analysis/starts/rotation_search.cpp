// SPDX-License-Identifier: MIT
#include "firmware/analysis/starts/rotation_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "core/numerics/rotations.hpp"
#include "firmware/analysis/starts/cube_rotations.hpp"

namespace armsig::calibration {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr int kMaxSteps = 60;

// Sum of squares, its gradient (halved) and Gauss-Newton matrix by (rotation vector in S, u).
struct Local {
  double squares = 0;
  Vector6 gradient;
  Matrix6 hessian;
};

using Matrix3x12 = Eigen::Matrix<double, 3, 12>;

// Y M, with Y(u) = [I, u_x I, u_y I, u_z I]. Written as sums of blocks: as matrix products of this
// size Eigen would fetch work space from a heap.
Matrix3x12 combined_rows(const Eigen::Matrix<double, 12, 12>& M, const Vector3& u) {
  Matrix3x12 sum = M.topRows<3>();
  for (int j = 0; j < 3; ++j) sum += u[j] * M.middleRows<3>(3 + 3 * j);
  return sum;
}

// M Y^T.
Matrix3 combined_columns(const Matrix3x12& M, const Vector3& u) {
  Matrix3 sum = M.leftCols<3>();
  for (int j = 0; j < 3; ++j) sum += u[j] * M.middleCols<3>(3 + 3 * j);
  return sum;
}

Local local_at(const Moments& m, const Matrix3& R, const Vector3& u) {
  const Matrix3x12 yg = combined_rows(m.gg, u);
  const Matrix3 yy = combined_columns(yg, u);
  const Matrix3 py = combined_columns(m.pg, u);
  Local local;
  local.squares = m.pp + yy.trace() - 2 * (R.transpose() * py).trace();
  // e = p - R y; de = -w x (R y) - R R_k du.
  const Matrix3 S = R * yy * R.transpose();
  local.hessian.topLeftCorner<3, 3>() = S.trace() * Matrix3::Identity() - S;
  const Matrix3 C = R * py.transpose();  // sum of (R y) p^T
  local.gradient.head<3>() << -(C(1, 2) - C(2, 1)), -(C(2, 0) - C(0, 2)), -(C(0, 1) - C(1, 0));
  for (int j = 0; j < 3; ++j) {
    const Matrix3 yj = yg.middleCols<3>(3 + 3 * j);  // sum of y (R_k e_j)^T
    const Vector3 cross(yj(1, 2) - yj(2, 1), yj(2, 0) - yj(0, 2), yj(0, 1) - yj(1, 0));
    local.hessian.block<3, 1>(0, 3 + j) = R * cross;
    local.hessian.block<1, 3>(3 + j, 0) = (R * cross).transpose();
    for (int i = 0; i < 3; ++i) {
      local.hessian(3 + i, 3 + j) = m.gg.block<3, 3>(3 + 3 * i, 3 + 3 * j).trace();
    }
    local.gradient[3 + j] = yj.trace() - (R.transpose() * m.pg.middleCols<3>(3 + 3 * j)).trace();
  }
  return local;
}

// The best u for a given rotation; directions of u that the poses hardly show stay short.
Vector3 tool_for(const Moments& m, const Matrix3& R) {
  const Local local = local_at(m, R, Vector3::Zero());
  Matrix3 H = local.hessian.bottomRightCorner<3, 3>();
  H.diagonal().array() += 1e-6 * m.weight;
  const Vector3 g = local.gradient.tail<3>();
  return -(H.inverse() * g);
}

}  // namespace

void Moments::add(const Vector3& p, const Vector12& g, double w) {
  if (w <= 0) return;
  weight += w;
  const Vector3 dp = p - mean_p;
  const Vector12 dg = g - mean_g;
  mean_p += w / weight * dp;
  mean_g += w / weight * dg;
  const double left = w * (1 - w / weight);
  pp += left * dp.squaredNorm();
  pg.noalias() += left * dp.lazyProduct(dg.transpose());
  gg.noalias() += left * dg.lazyProduct(dg.transpose());
}

Vector3 combined(const Vector12& g, const Vector3& u) {
  Vector3 sum = g.head<3>();
  for (int j = 0; j < 3; ++j) sum += u[j] * g.segment<3>(3 + 3 * j);
  return sum;
}

double polish(const Moments& m, Candidate& candidate) {
  double damping = 1e-3;
  Local local = local_at(m, candidate.R, candidate.u);
  for (int i = 0; i < kMaxSteps; ++i) {
    Matrix6 H = local.hessian;
    for (int k = 0; k < 6; ++k) H(k, k) += damping * H(k, k) + 1e-9 * m.weight;
    const Vector6 x = -H.ldlt().solve(local.gradient);
    const Matrix3 R = numerics::rotation_by(x.head<3>()) * candidate.R;
    const Vector3 u = candidate.u + x.tail<3>();
    const Local next = local_at(m, R, u);
    if (next.squares < local.squares) {
      candidate = {R, u};
      local = next;
      damping = std::max(0.1 * damping, 1e-12);
      if (x.norm() < 1e-10) break;
    } else {
      damping *= 10;
      if (damping > 1e6) break;
    }
  }
  return local.squares;
}

Candidate search(const Moments& m) {
  Candidate best;
  double least = std::numeric_limits<double>::infinity();
  for_each_cube_rotation([&](const Matrix3& R) {
    Candidate candidate{R, tool_for(m, R)};
    const double squares = polish(m, candidate);
    if (std::isfinite(least) && !(squares < least)) return;
    least = squares;
    best = candidate;
  });
  return best;
}

}  // namespace armsig::calibration
