// SPDX-License-Identifier: MIT
#include "firmware/self_calibration/play.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace armsig::controller {
namespace {

using Index = Eigen::Index;

// Information [m^2] of a joint that hardly moves the target: a micrometre per radian.
constexpr double kLeastInformation = 1e-12;

}  // namespace

void PlayEstimate::add(Sides sides, const Motions& motions, const Vector3& residual) {
  for (std::size_t i = 0; i < joints_; ++i) {
    const Vector3 a = -side_of(sides, i) * motions[i];
    pull_(static_cast<Index>(i)) += a.dot(residual);
    for (std::size_t j = 0; j < joints_; ++j) {
      information_(static_cast<Index>(i), static_cast<Index>(j)) -=
          side_of(sides, j) * a.dot(motions[j]);
    }
  }
}

double PlayEstimate::Half::squared() const { return is_seen() ? value * value - sigma * sigma : 0; }

PlayEstimate::Halves PlayEstimate::result(double sigma_m) const {
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
    halves.push_back({h(k), sigma_m * std::sqrt(std::max(column(k), 0.0))});
  }
  return halves;
}

}  // namespace armsig::controller
