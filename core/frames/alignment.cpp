// SPDX-License-Identifier: MIT
#include "core/frames/alignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Jacobi>

#include "core/numerics/cholesky.hpp"
#include "core/numerics/rotations.hpp"

namespace armsig::frames {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// The Gauss-Newton equations of the cost in (turn about `pivot` times size, translation), so that
// all six unknowns are lengths.
struct Equations {
  Matrix6 hessian = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
};

bool is_revolute(const AxisLine& line) { return line.type == JointType::kRevolute; }

Vector3 mean_point(const AxisLines& lines) {
  Vector3 sum = Vector3::Zero();
  double count = 0;
  for (const AxisLine& line : lines) {
    if (!is_revolute(line)) continue;
    sum += line.point;
    count += 1;
  }
  return count > 0 ? Vector3(sum / count) : sum;
}

// Both residuals change with the turn w by w x what is turned, so their products with themselves
// are written out: with J = -[u]x, J^T J = |u|^2 I - u u^T, and J^T r = u x r.
Equations equations(const AxisLines& lines_A, const AxisLines& lines_B, const Pose& X_AB,
                    const Vector3& pivot_A, double size_m) {
  Equations sums;
  auto turns = sums.hessian.topLeftCorner<3, 3>();
  auto turns_moves = sums.hessian.topRightCorner<3, 3>();
  auto moves = sums.hessian.bottomRightCorner<3, 3>();
  auto turned = sums.gradient.head<3>();
  auto shifted = sums.gradient.tail<3>();
  for (std::size_t i = 0; i < lines_A.size(); ++i) {
    const Vector3& axis_A = lines_A[i].direction;
    const Vector3 direction_A = X_AB.R * lines_B[i].direction;
    turns += Matrix3::Identity() - direction_A * direction_A.transpose();
    turned -= size_m * direction_A.cross(axis_A);
    if (!is_revolute(lines_A[i])) continue;
    // Across the axis alone: P = I - axis axis^T stands before residual and derivatives.
    const Vector3 point_A = X_AB * lines_B[i].point;
    const Vector3 lever = (point_A - pivot_A) / size_m;
    const Vector3 about = lever.cross(axis_A);
    const Vector3 apart = point_A - lines_A[i].point;
    const Vector3 across = apart - axis_A * axis_A.dot(apart);
    turns += lever.squaredNorm() * Matrix3::Identity() - lever * lever.transpose() -
             about * about.transpose();
    turns_moves += cross_matrix(lever) - about * axis_A.transpose();
    moves += Matrix3::Identity() - axis_A * axis_A.transpose();
    turned += lever.cross(across);
    shifted += across;
  }
  sums.hessian.bottomLeftCorner<3, 3>() = turns_moves.transpose();
  return sums;
}

double cost(const AxisLines& lines_A, const AxisLines& lines_B, const Pose& X_AB, double size_m) {
  double cost_m2 = 0;
  for (std::size_t i = 0; i < lines_A.size(); ++i) {
    const Vector3& axis_A = lines_A[i].direction;
    cost_m2 += (size_m * (X_AB.R * lines_B[i].direction - axis_A)).squaredNorm();
    if (!is_revolute(lines_A[i])) continue;
    const Vector3 apart = X_AB * lines_B[i].point - lines_A[i].point;
    cost_m2 += (apart - axis_A * axis_A.dot(apart)).squaredNorm();
  }
  return cost_m2;
}

struct Spectrum {
  Vector6 values;
  Matrix6 vectors = Matrix6::Identity();  // by columns
};

// Eigenvalues and eigenvectors of a symmetric matrix by cyclic Jacobi rotations (Golub and Van
// Loan, Matrix Computations, section 8.5): a quarter of the work of a singular value decomposition.
Spectrum spectrum_of(Matrix6 A) {
  constexpr int kMaxSweeps = 20;  // converges quadratically, in six or seven
  const double negligible = std::numeric_limits<double>::epsilon() * A.norm();
  Spectrum spectrum;
  bool rotated = true;
  for (int sweep = 0; sweep < kMaxSweeps && rotated; ++sweep) {
    rotated = false;
    for (Eigen::Index p = 0; p < 6; ++p) {
      for (Eigen::Index q = p + 1; q < 6; ++q) {
        if (std::abs(A(p, q)) <= negligible) continue;
        Eigen::JacobiRotation<double> rotation;
        rotation.makeJacobi(A, p, q);
        A.applyOnTheLeft(p, q, rotation.adjoint());
        A.applyOnTheRight(p, q, rotation);
        spectrum.vectors.applyOnTheRight(p, q, rotation);
        rotated = true;
      }
    }
  }
  spectrum.values = A.diagonal();
  return spectrum;
}

// What of the minimiser of the equations the lines determine to better than one part in a hundred.
Vector6 determined_step(const Equations& of) {
  constexpr double kDeterminedFraction = 1e-4;  // the square of one part in a hundred
  // All six directions are determined where the least eigenvalue is known to be large: it is the
  // determinant over the product of the five others, which is at most the fifth power of their
  // mean.
  numerics::Square factor;
  numerics::Column solution;
  factor.topLeftCorner<6, 6>() = of.hessian;
  solution.head<6>() = -of.gradient;
  if (numerics::solve_positive(factor, solution, 6)) {
    const double trace = of.hessian.trace();
    const double root = factor.diagonal().head<6>().prod();
    const double mean = trace / 5;
    if (root * root > kDeterminedFraction * trace * mean * mean * mean * mean * mean) {
      return solution.head<6>();
    }
  }
  const Spectrum spectrum = spectrum_of(of.hessian);
  const double least_information = kDeterminedFraction * spectrum.values.maxCoeff();
  Vector6 along = spectrum.vectors.transpose() * of.gradient;
  for (Eigen::Index i = 0; i < 6; ++i) {
    along(i) = spectrum.values(i) > least_information ? along(i) / spectrum.values(i) : 0;
  }
  return -(spectrum.vectors * along);
}

// X_AB after a turn about the pivot and a translation, both in A.
Pose moved(const Pose& X_AB, const Vector3& pivot_A, const Vector3& turn_rad,
           const Vector3& translation) {
  const Matrix3 turn = numerics::rotation_by(turn_rad);
  // A descent is of few enough turns that their product stays a rotation to rounding.
  return {turn * X_AB.R, pivot_A + turn * (X_AB.p - pivot_A) + translation};
}

}  // namespace

double Alignment::worst_angle_rad() const {
  return std::ranges::max(joints, {}, &Misalignment::angle_rad).angle_rad;
}

double Alignment::worst_distance_m() const {
  return std::ranges::max(joints, {}, &Misalignment::distance_m).distance_m;
}

Alignment align(const AxisLines& lines_A, const AxisLines& lines_B) {
  Aligning aligning(lines_A, lines_B);
  while (aligning.step()) {
  }
  return aligning.result();
}

Aligning::Aligning(const AxisLines& lines_A, const AxisLines& lines_B)
    : lines_A_(lines_A),
      lines_B_(lines_B),
      size_m_(arm_size(lines_A)),
      mean_B_(mean_point(lines_B)),
      descent_(start()) {
  ARMSIG_CHECK(!lines_A.empty() && lines_A.size() == lines_B.size());
}

// z to one of six sides of a cube, then a quarter turn about it.
Aligning::Descent Aligning::start() const {
  const int side = starts_ / 4;
  const Matrix3 tilt = side < 4 ? rotation_x(side * kPi / 2)
                                : rotation_about(Vector3::UnitY(), (side == 4 ? 1 : -1) * kPi / 2);
  const Matrix3 R_AB = tilt * rotation_z((starts_ % 4) * kPi / 2);
  const Pose X_AB{R_AB, mean_point(lines_A_) - R_AB * mean_B_};
  return {X_AB, cost(lines_A_, lines_B_, X_AB, size_m_)};
}

bool Aligning::step() {
  constexpr int kMaxSteps = 30;
  constexpr double kClearlyBetter = 1e-6;  // of the size squared: two starts that found one minimum
  // Of the size: the step after one of this length changes the cost by far less than that.
  constexpr double kNearStep = 1e-4;
  constexpr double kNegligibleStep = 1e-13;
  if (starts_ > kStarts) return false;
  const bool refines = starts_ == kStarts;
  if (descend(refines ? kNegligibleStep : kNearStep) && ++steps_ < kMaxSteps) return true;
  steps_ = 0;
  const double equal_cost_m2 = kClearlyBetter * size_m_ * size_m_;
  if (refines || starts_ == 0 || descent_.cost_m2 < best_.cost_m2 - equal_cost_m2) best_ = descent_;
  // No start is clearly better than one without a cost.
  starts_ = best_.cost_m2 <= equal_cost_m2 && starts_ < kStarts ? kStarts : starts_ + 1;
  descent_ = starts_ < kStarts ? start() : best_;
  return starts_ <= kStarts;
}

bool Aligning::descend(double near) {
  constexpr int kMaxHalvings = 8;
  constexpr double kNoWorse = 1.0 + 1e-12;  // a cost that differs by rounding is no worse
  const Pose X_AB = descent_.X_AB;
  const Vector3 pivot_A = X_AB * mean_B_;
  Vector6 step = determined_step(equations(lines_A_, lines_B_, X_AB, pivot_A, size_m_));
  for (int halving = 0; halving < kMaxHalvings; ++halving, step *= 0.5) {
    const Pose X_next = moved(X_AB, pivot_A, step.head<3>() / size_m_, step.tail<3>());
    const double cost_m2 = cost(lines_A_, lines_B_, X_next, size_m_);
    if (cost_m2 > descent_.cost_m2 * kNoWorse) continue;
    descent_ = {X_next, cost_m2};
    return step.norm() >= near * size_m_;
  }
  return false;
}

Alignment Aligning::result() const {
  Alignment alignment{best_.X_AB, {}, best_.cost_m2};
  for (std::size_t i = 0; i < lines_A_.size(); ++i) {
    const Vector3 direction_A = best_.X_AB.R * lines_B_[i].direction;
    Misalignment left;
    left.angle_rad = numerics::angle_between(direction_A, lines_A_[i].direction);
    if (is_revolute(lines_A_[i])) {
      const Vector3 apart = best_.X_AB * lines_B_[i].point - lines_A_[i].point;
      left.distance_m = lines_A_[i].direction.cross(apart).norm();
    }
    alignment.joints.push_back(left);
  }
  return alignment;
}

}  // namespace armsig::frames
