// SPDX-License-Identifier: MIT
#include "firmware/self_calibration/play.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace armsig::controller {
namespace {

using Index = Eigen::Index;

// Information [1/rad^2 or 1/m^2] of a joint that hardly moves the target: 1 sigma of one.
constexpr double kLeastInformation = 1;

}  // namespace

void PlayEstimate::add(Sides sides, const Motions& motions, const Vector3& error_m,
                       const Matrix3& information) {
  for (std::size_t i = 0; i < joints_; ++i) {
    const Vector3 a = -side_of(sides, i) * (information * motions[i]);
    pull_(static_cast<Index>(i)) += a.dot(error_m);
    for (std::size_t j = 0; j < joints_; ++j) {
      information_(static_cast<Index>(i), static_cast<Index>(j)) -=
          side_of(sides, j) * a.dot(motions[j]);
    }
  }
}

double PlayEstimate::Half::squared() const {
  return std::isfinite(sigma) ? value * value - sigma * sigma : 0;
}

double PlayEstimate::Half::squared_variance() const {
  if (!std::isfinite(sigma)) return 0;
  return sigma * sigma * (2 * sigma * sigma + 4 * std::max(squared(), 0.0));
}

PlayEstimate::Halves PlayEstimate::result() const {
  Matrix damped = information_ + kLeastInformation * Matrix::Identity();
  const Eigen::LLT<Matrix> factor(damped);
  const Eigen::Matrix<double, kMaxJoints, 1> h = factor.solve(pull_);
  Halves halves;
  for (std::size_t i = 0; i < joints_; ++i) {
    const auto k = static_cast<Index>(i);
    if (!(information_(k, k) > kLeastInformation)) {
      halves.push_back({0, std::numeric_limits<double>::infinity()});
      continue;
    }
    Eigen::Matrix<double, kMaxJoints, 1> unit = Eigen::Matrix<double, kMaxJoints, 1>::Zero();
    unit(k) = 1;
    const Eigen::Matrix<double, kMaxJoints, 1> column = factor.solve(unit);
    halves.push_back({h(k), std::sqrt(std::max(column(k), 0.0))});
  }
  return halves;
}

}  // namespace armsig::controller
