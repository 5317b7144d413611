// SPDX-License-Identifier: MIT
// Gauss-Newton on accumulated statistics: the fit of a constrained motion, such as a circle, to the
// triangular factor of the unconstrained one.
//
// With Phi (3 regressors x 3 coordinates) the coefficients of a motion, the squared distance of all
// the points from it is, up to a constant,
//   | (R Phi - Z) W |^2,   W W^T = inverse of the mean covariance shape of a point.
// Row 0 of Phi, the target at the origin reading, is free and R is triangular: it makes row 0 of
// the difference vanish whatever the others are. So only rows 1 and 2, the parameters psi of the
// motion about that target, are left to iterate on: six numbers that each step reads.
#pragma once

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>

#include "core/base/error.hpp"
#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

// Rows 1 and 2 of Phi.
using MotionRows = Eigen::Matrix<double, 2, 3>;

// Their derivative by psi, row 1 before row 2.
template <int kParameters>
using MotionJacobian = Eigen::Matrix<double, 6, kParameters>;

// Motion: a plain struct with the parameters psi and
//   static constexpr int kParameters
//   MotionRows rows() const
//   MotionJacobian<kParameters> jacobian() const
//   Motion moved(const Eigen::Matrix<double, kParameters, 1>& step) const
//   bool is_small(const Eigen::Matrix<double, kParameters, 1>& step) const   so small that the next
//   step, smaller by the noise over the size of the motion, is rounding
template <typename Motion>
class ConstrainedFit {
 public:
  static constexpr int kParameters = Motion::kParameters;
  using Step = Eigen::Matrix<double, kParameters, 1>;
  // Of (target, psi).
  using Covariance = Eigen::Matrix<double, 3 + kParameters, 3 + kParameters>;

  // Precondition: at least one point, each with a positive definite covariance.
  explicit ConstrainedFit(const MotionStatistics& statistics)
      : statistics_(statistics),
        R_(statistics.motion.factor()),
        Z_(statistics.motion.rotated_right_hand_sides()),
        shape_(statistics.shape()),
        shape_inverse_(shape_.inverse()),
        whitening_(shape_inverse_.llt().matrixL()) {}

  struct Fitted {
    Motion motion;
    // Of psi: inverse * inverse^T is its covariance where every point has the same.
    typename SquareRootRls<kParameters, 1>::Factor inverse;
  };

  // The motion of greatest likelihood, from a start in its neighbourhood.
  // Errors: kSingular, kNotConverged.
  // A function of its own, as is covariance(): otherwise all their matrices stand on the stack
  // together.
  [[nodiscard]] [[gnu::noinline]] Result<Fitted> maximise_likelihood(Motion motion) const {
    double least = cost(motion);
    for (int iteration = 0; iteration < kMostIterations; ++iteration) {
      const LinearProblem linearised = linearise(motion);
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
      if (improved && !motion.is_small(step)) continue;
      ARMSIG_TRY(inverse, linearised.inverse_factor());
      return Fitted{motion, inverse};
    }
    return std::unexpected(Error::kNotConverged);
  }

  // Row 0 of Phi that goes with `motion`: the target at the origin reading, about the origin.
  [[nodiscard]] Vector3 target(const Motion& motion) const {
    const Eigen::RowVector3d rest = Z_.row(0) - R_.template block<1, 2>(0, 1) * motion.rows();
    return rest.transpose() / R_(0, 0);
  }

  // H^-1 M H^-1, with H the information and M the covariance of the score: the inverse of H where
  // every point has the same covariance, true also where they differ.
  [[nodiscard]] [[gnu::noinline]] Covariance covariance(const Fitted& fitted) const {
    using OfPsi = Eigen::Matrix<double, kParameters, kParameters>;
    using OnTarget = Eigen::Matrix<double, 3, kParameters>;
    const MotionJacobian<kParameters> D = fitted.motion.jacobian();
    // How the target follows psi, for row 0 to stay zero.
    const OnTarget follows =
        (R_(0, 1) * D.template topRows<3>() + R_(0, 2) * D.template bottomRows<3>()) / -R_(0, 0);
    // Plain sums: for products of this size Eigen would prepare a heap.
    const OfPsi of_psi = fitted.inverse.lazyProduct(fitted.inverse.transpose());
    const OnTarget with_target = follows.lazyProduct(of_psi);
    Covariance inverse;
    inverse.template topLeftCorner<3, 3>() =
        shape_ / (R_(0, 0) * R_(0, 0)) + with_target.lazyProduct(follows.transpose());
    inverse.template topRightCorner<3, kParameters>() = with_target;
    inverse.template bottomLeftCorner<kParameters, 3>() = with_target.transpose();
    inverse.template bottomRightCorner<kParameters, kParameters>() = of_psi;
    if (statistics_.has_one_covariance()) return inverse;

    Eigen::Matrix<double, 9, 3 + kParameters> influence;
    influence.template topRows<3>() = shape_inverse_.lazyProduct(inverse.template topRows<3>());
    for (int i = 0; i < 6; i += 3) {
      const Eigen::Matrix<double, 3, 3 + kParameters> moves =
          D.template middleRows<3>(i).lazyProduct(inverse.template bottomRows<kParameters>());
      influence.template middleRows<3>(3 + i) = shape_inverse_.lazyProduct(moves);
    }
    const Eigen::Matrix<double, 9, 3 + kParameters> scored =
        statistics_.score_covariance().lazyProduct(influence);
    return Covariance(influence.transpose().lazyProduct(scored));
  }

 private:
  using LinearProblem = SquareRootRls<kParameters, 1>;
  static constexpr int kMostIterations = 100;
  static constexpr int kMostHalvings = 40;
  static constexpr double kFlat = 1e-9;

  // The lower two rows of `R Phi`, in units of the noise.
  [[nodiscard]] MotionRows seen(const MotionRows& rows) const {
    MotionRows product;
    product.row(0) = R_(1, 1) * rows.row(0) + R_(1, 2) * rows.row(1);
    product.row(1) = R_(2, 2) * rows.row(1);
    return product.lazyProduct(whitening_);
  }
  [[nodiscard]] MotionRows measured() const {
    return Z_.template bottomRows<2>().lazyProduct(whitening_);
  }

  [[nodiscard]] double cost(const Motion& motion) const {
    const double squares = (seen(motion.rows()) - measured()).squaredNorm();
    return std::isfinite(squares) ? squares : std::numeric_limits<double>::infinity();
  }

  [[nodiscard]] LinearProblem linearise(const Motion& motion) const {
    const MotionRows rest = measured() - seen(motion.rows());
    const MotionJacobian<kParameters> D = motion.jacobian();
    MotionJacobian<kParameters> moves;
    for (int k = 0; k < kParameters; ++k) {
      const MotionRows change = seen(D.col(k).template reshaped<Eigen::RowMajor>(2, 3));
      moves.col(k) = change.template reshaped<Eigen::RowMajor>();
    }
    LinearProblem linearised;
    for (int i = 0; i < 6; ++i)
      linearised.update(moves.row(i), rest.template block<1, 1>(i / 3, i % 3));
    return linearised;
  }

  const MotionStatistics& statistics_;
  Matrix3 R_;
  Matrix3 Z_;
  Matrix3 shape_;
  Matrix3 shape_inverse_;
  Matrix3 whitening_;
};

}  // namespace armsig::features
