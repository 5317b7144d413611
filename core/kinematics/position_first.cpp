// SPDX-License-Identifier: MIT
#include "core/kinematics/position_first.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/base/low_discrepancy.hpp"
#include "core/numerics/cholesky.hpp"

namespace armsig::kinematics {
namespace {

// Least part of the lever by which an arm moves its tip in a third direction. The axes of an
// individual arm deviate by a hundredth at most; what moves in three directions has a fifth.
constexpr double kThirdDirection = 0.04;
constexpr int kPosesTried = 8;
// Relative to the largest: below, rounding decides on the direction.
constexpr double kLeastPivot = 1e-12;
constexpr double kRegularisation = 1e-12;

// Beyond a bound by this is at it [rad or m]: below what a position may be missed by.
constexpr double kAtBound = 1e-11;

// The parts of column i of a Jacobian, for the position and the orientation.
Vector3 moving(const Jacobian& J, std::size_t i) { return Vector3(J.data() + 6 * i); }
Vector3 turning(const Jacobian& J, std::size_t i) { return Vector3(J.data() + 6 * i + 3); }

// Whether the joints whose columns are not zero move the tip in three directions, and not by the
// deviations of their axes alone. The smallest singular value of A, in units of the arm, is no less
// than the volume of all three over the root of the squared areas of any two.
bool moves_in_three_directions(const Chain& chain, const Jacobian& J) {
  Matrix3 G = Matrix3::Zero();
  for (std::size_t i = 0; i < chain.joint_count; ++i) {
    const Vector3 column = (chain.revolute[i] ? 1 / chain.length : 1) * moving(J, i);
    G += column * column.transpose();
  }
  const double areas = G(0, 0) * G(1, 1) - G(0, 1) * G(1, 0) + G(0, 0) * G(2, 2) -
                       G(0, 2) * G(2, 0) + G(1, 1) * G(2, 2) - G(1, 2) * G(2, 1);
  return G.determinant() > kThirdDirection * kThirdDirection * areas;
}

// The largest part of `dq` that stays inside the box.
double part_inside(const JointBox& box, const Joints& q, const Joints& dq, Eigen::Index n) {
  double part = 1;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double room = (dq[i] > 0 ? box.upper : box.lower)[i] - q[i];
    if (std::abs(part * dq[i]) > std::abs(room)) part = room / dq[i];
  }
  return part;
}

}  // namespace

bool is_position_first(const Chain& chain) {
  if (chain.joint_count < 3 || chain.joint_count > 5) return false;
  for (int k = 1; k <= kPosesTried; ++k) {
    JointVector q;
    for (std::size_t i = 0; i < chain.joint_count; ++i) {
      q.push_back(chain.revolute[i] ? 2 * kPi * halton(i, k) : 0);
    }
    const auto at = forward_with_jacobian(chain, q);
    if (!at) return false;
    if (moves_in_three_directions(chain, at->J)) return true;
  }
  return false;
}

// Loops over columns, here and below: as products of matrices they would take an image twice the
// room.
PositionFirst::PositionFirst(const Jacobian& J) {
  Matrix3 G = Matrix3::Zero();  // A A^T
  Matrix3 C = Matrix3::Zero();  // B A^T
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    moves_[i] = moving(J, i);
    stays_[i] = turning(J, i);
    G += moves_[i] * moves_[i].transpose();
    C += stays_[i] * moves_[i].transpose();
  }
  const double largest = std::max({G(0, 0), G(1, 1), G(2, 2)});
  regular_ = G.determinant() > kLeastPivot * largest * largest * largest;
  if (!regular_) return;
  turn_per_move_ = C * G.inverse();
  for (std::size_t i = 0; i < kMaxJoints; ++i) stays_[i] -= turn_per_move_ * moves_[i];
}

// The rows of A and those that stay are at right angles: the square of each volume is a factor of
// its determinant. `added` to the diagonal.
Square PositionFirst::normal(double added) const {
  Square normal = Square::Zero();
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    for (std::size_t k = 0; k < kMaxJoints; ++k) {
      const double product = moves_[i].dot(moves_[k]) + stays_[i].dot(stays_[k]);
      normal(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          product + (i == k ? added : 0);
    }
  }
  return normal;
}

double PositionFirst::volume(Eigen::Index n) const {
  if (!regular_) return 0;
  Square factor = normal(0);
  if (!numerics::factor_positive(factor, n)) return 0;
  double volume = 1;
  for (Eigen::Index i = 0; i < n; ++i) volume *= factor(i, i);
  return volume;
}

bool PositionFirst::step(const PoseError& error, Eigen::Index n, Joints& dq) const {
  const Vector3 left = rotation_left(error);
  double squares = 0;
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    dq[static_cast<Eigen::Index>(i)] = moves_[i].dot(error.head<3>()) + stays_[i].dot(left);
    squares += moves_[i].squaredNorm() + stays_[i].squaredNorm();
  }
  Square regularised = normal(kRegularisation * squares);
  return numerics::solve_positive(regularised, dq, n);
}

TaskStep position_first_step(const Chain& chain, Jacobian J, PoseError error, const JointBox& box,
                             const Joints& q, Joints& dq) {
  const auto n = static_cast<Eigen::Index>(chain.joint_count);
  Joints unbounded = Joints::Zero();
  Joints to_bounds = Joints::Zero();
  for (Eigen::Index fixed = 0; fixed < n; ++fixed) {
    const PositionFirst task(J);
    if (!task.is_regular() || !task.step(error, n, dq)) break;
    if (fixed == 0) unbounded = dq;
    Eigen::Index worst = 0;
    double beyond = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double by = std::max(q[i] + dq[i] - box.upper[i], box.lower[i] - q[i] - dq[i]);
      if (by > beyond) worst = i;
      beyond = std::max(beyond, by);
    }
    if (!(beyond > kAtBound)) {
      dq += to_bounds;
      return TaskStep::kFound;
    }
    to_bounds[worst] = (dq[worst] > 0 ? box.upper : box.lower)[worst] - q[worst];
    error -= to_bounds[worst] * J.col(worst);
    J.col(worst).setZero();
    if (!moves_in_three_directions(chain, J)) break;
  }
  if (unbounded.isZero(0)) return TaskStep::kSingular;
  dq = part_inside(box, q, unbounded, n) * unbounded;
  return dq.cwiseAbs().maxCoeff() > kAtBound ? TaskStep::kFound : TaskStep::kBounded;
}

}  // namespace armsig::kinematics
