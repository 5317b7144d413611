// SPDX-License-Identifier: MIT
// Weights at the link origins, all pulled along one vertical that is not known: a bilinear least
// squares problem. With the vertical known, the coefficients are linear, and the reverse.
#pragma once

#include <utility>

#include <Eigen/Core>

#include "core/base/pose.hpp"

namespace armsig::tool {

class WeightsAlong {
 public:
  // Least is ½ x' own x - score' x, x_(3t+i) = c_t u_i: coefficient t [rad/m, or rad or m of a
  // slide] times component i of the vertical. `variance` of the residuals weighs the coefficients'
  // prior.
  WeightsAlong(Eigen::MatrixXd own, Eigen::VectorXd score, double variance);

  // By how much the square sum of the residuals falls with `up_0` as the vertical.
  [[nodiscard]] double gain(const Vector3& up_0) const;

  // The best vertical, on the side on which most joints give way downwards; and its gain.
  [[nodiscard]] std::pair<Vector3, double> best() const;

 private:
  [[nodiscard]] Eigen::VectorXd coefficients(const Vector3& up_0) const;
  [[nodiscard]] Vector3 better(const Vector3& up_0) const;
  [[nodiscard]] double gives_way(const Vector3& up_0) const;

  Eigen::MatrixXd own_;  // with the prior
  Eigen::VectorXd score_;
};

}  // namespace armsig::tool
