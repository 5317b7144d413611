// SPDX-License-Identifier: MIT
// Gauss-Newton on accumulated statistics: the fit of a constrained motion, such as a circle, to the
// triangular factor of the unconstrained one.
//
// With Phi (3 regressors x 3 coordinates) the coefficients that a motion of parameters psi has, the
// squared distance of all the points from it is, up to a constant,
//   | (R Phi(psi) - Z) W |^2,   W W^T = inverse of the mean covariance shape of a point,
// whose nine rows are all that each step reads.
#pragma once

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>

#include "core/base/error.hpp"
#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

// d Phi / d psi, Phi taken row by row.
template <int kParameters>
using MotionJacobian = Eigen::Matrix<double, 9, kParameters>;

// Motion: a plain struct of parameters with
//   static constexpr int kParameters
//   MotionRls::Coefficients coefficients() const
//   MotionJacobian<kParameters> jacobian() const
//   Motion moved(const Eigen::Matrix<double, kParameters, 1>& step) const
//   bool is_small(const Eigen::Matrix<double, kParameters, 1>& step) const   at the level of
//   rounding
template <typename Motion>
class ConstrainedFit {
 public:
  static constexpr int kParameters = Motion::kParameters;
  using Step = Eigen::Matrix<double, kParameters, 1>;
  using Covariance = Eigen::Matrix<double, kParameters, kParameters>;

  // Precondition: at least one point, each with a positive definite covariance.
  explicit ConstrainedFit(const SweepStatistics& statistics)
      : R_(statistics.motion.factor()),
        Z_(statistics.motion.rotated_right_hand_sides()),
        shape_inverse_(statistics.shape().inverse()),
        whitening_(shape_inverse_.llt().matrixL()),
        score_(statistics.score_covariance()) {}

  // The motion of greatest likelihood, from a start in its neighbourhood.
  // Errors: kSingular, kNotConverged.
  [[nodiscard]] Result<Motion> maximise_likelihood(Motion motion) const {
    double least = cost(motion);
    for (int iteration = 0; iteration < kMostIterations; ++iteration) {
      const Linearised linearised = linearise(motion);
      if (linearised.rank() < kParameters) return std::unexpected(Error::kSingular);
      Step step = linearised.solve();
      bool improved = false;
      for (int halving = 0; halving < kMostHalvings && !improved; ++halving) {
        const Motion tried = motion.moved(step);
        const double tried_cost = cost(tried);
        // Near the minimum the cost is flat to rounding while the step still gains digits.
        if (tried_cost <= least * (1 + kFlat)) {
          motion = tried;
          least = tried_cost;
          improved = true;
        } else {
          step /= 2;
        }
      }
      if (!improved || motion.is_small(step)) return motion;
    }
    return std::unexpected(Error::kNotConverged);
  }

  // H^-1 M H^-1, with H the information at `motion` and M the covariance of the score: the inverse
  // of H where every point has the same covariance, true also where they differ.
  // Errors: kSingular.
  [[nodiscard]] Result<Covariance> covariance(const Motion& motion) const {
    ARMSIG_TRY(root, linearise(motion).inverse_factor());
    const MotionJacobian<kParameters> D = motion.jacobian();
    MotionJacobian<kParameters> weighted;
    for (int i = 0; i < 9; i += 3)
      weighted.template middleRows<3>(i) = shape_inverse_ * D.template middleRows<3>(i);
    // Plain sums: for products of this size Eigen would prepare a heap.
    const Covariance inverse_information = root.lazyProduct(root.transpose());
    const MotionJacobian<kParameters> influence = weighted.lazyProduct(inverse_information);
    const MotionJacobian<kParameters> scored = score_.lazyProduct(influence);
    return Covariance(influence.transpose().lazyProduct(scored));
  }

 private:
  using Linearised = SquareRootRls<kParameters, 1>;
  static constexpr int kMostIterations = 100;
  static constexpr int kMostHalvings = 40;
  static constexpr double kFlat = 1e-9;

  [[nodiscard]] double cost(const Motion& motion) const {
    const double squares = ((R_ * motion.coefficients() - Z_) * whitening_).squaredNorm();
    return std::isfinite(squares) ? squares : std::numeric_limits<double>::infinity();
  }

  [[nodiscard]] Linearised linearise(const Motion& motion) const {
    const Matrix3 rest = (Z_ - R_ * motion.coefficients()) * whitening_;
    const MotionJacobian<kParameters> D = motion.jacobian();
    MotionJacobian<kParameters> rows;
    for (int k = 0; k < kParameters; ++k) {
      Matrix3 change;
      for (int i = 0; i < 3; ++i) change.row(i) = D.template block<3, 1>(3 * i, k).transpose();
      const Matrix3 seen = R_ * change * whitening_;
      for (int i = 0; i < 3; ++i) rows.template block<3, 1>(3 * i, k) = seen.row(i).transpose();
    }
    Linearised linearised;
    for (int i = 0; i < 9; ++i)
      linearised.update(rows.row(i).transpose(), Eigen::Matrix<double, 1, 1>(rest(i / 3, i % 3)));
    return linearised;
  }

  Matrix3 R_;
  Matrix3 Z_;
  Matrix3 shape_inverse_;
  Matrix3 whitening_;
  Eigen::Matrix<double, 9, 9> score_;
};

}  // namespace armsig::features
