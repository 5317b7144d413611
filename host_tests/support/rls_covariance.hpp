// SPDX-License-Identifier: MIT
// Recursive least squares in the textbook's covariance form: the check of the square-root form.
//
// It needs a start value for the covariance, which biases the answer, and loses digits with every
// update; nothing but tests and benchmarks should use it.
#pragma once

#include <Eigen/Core>

namespace armsig::features {

template <int kRegressors, int kRightHandSides, typename Scalar = double>
class CovarianceRls {
 public:
  using Regressors = Eigen::Matrix<Scalar, kRegressors, 1>;
  using RightHandSides = Eigen::Matrix<Scalar, kRightHandSides, 1>;
  using Factor = Eigen::Matrix<Scalar, kRegressors, kRegressors>;
  using Coefficients = Eigen::Matrix<Scalar, kRegressors, kRightHandSides>;

  // start_variance: of each coefficient before the first measurement, in units of the variance of a
  // measurement; larger means less bias and more rounding.
  explicit CovarianceRls(Scalar start_variance) : P_(start_variance * Factor::Identity()) {}

  // gain = P x / (1 + x^T P x); coefficients += gain * innovation; P -= gain (P x)^T, kept
  // symmetric.
  void update(const Regressors& x, const RightHandSides& y) {
    const Regressors Px = P_ * x;
    const Regressors gain = Px / (1 + x.dot(Px));
    const RightHandSides innovation = y - coefficients_.transpose() * x;
    coefficients_ += gain * innovation.transpose();
    const Factor shrunk = P_ - gain * Px.transpose();
    P_ = Scalar(0.5) * (shrunk + shrunk.transpose());
  }

  [[nodiscard]] const Coefficients& coefficients() const { return coefficients_; }
  [[nodiscard]] const Factor& covariance() const { return P_; }

 private:
  Factor P_;
  Coefficients coefficients_ = Coefficients::Zero();
};

}  // namespace armsig::features
