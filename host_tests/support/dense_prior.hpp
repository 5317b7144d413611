// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Dense>

#include "core/calibration/reading_map.hpp"

namespace armsig::test {

// The precision of a reading map's prior, written out.
inline Eigen::MatrixXd dense_prior() {
  using calibration::kKnots;
  using calibration::kSplines;
  Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(kKnots, kKnots);
  const auto stencil = calibration::map_prior();
  for (std::size_t i = 0; i < kKnots; ++i) {
    for (std::size_t k = 0; k < kSplines; ++k) {
      const auto a = static_cast<Eigen::Index>(i);
      const auto b = static_cast<Eigen::Index>((i + k) % kKnots);
      Q(a, b) = Q(b, a) = stencil[k];
    }
  }
  return Q;
}

}  // namespace armsig::test
