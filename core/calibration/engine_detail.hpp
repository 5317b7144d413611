// SPDX-License-Identifier: MIT
// What the parts of the engine share.
#pragma once

#include <array>

#include "core/base/pose.hpp"

namespace armsig::calibration {

// Sigma is at least a micrometre: below it few rows could seem exact.
inline constexpr double kLeastVariance = 1e-12;

// Multiplications, about, of factorising a map's band, and of solving with it.
inline constexpr std::size_t kMapFactor = 5000;
inline constexpr std::size_t kMapSolution = 1600;

// The matrix of xx, xy, xz, yy, yz, zz.
[[nodiscard]] inline Matrix3 symmetric(const std::array<float, 6>& packed) {
  const auto at = [&](std::size_t k) { return static_cast<double>(packed[k]); };
  return Matrix3{{at(0), at(1), at(2)}, {at(1), at(3), at(4)}, {at(2), at(4), at(5)}};
}

// How joint i moves a point: about its axis, or along it.
[[nodiscard]] inline Vector3 motion_of(bool revolute, const Pose& X_SJ, const Vector3& p_S) {
  const Vector3 z = X_SJ.R.col(2);
  return revolute ? Vector3(z.cross(p_S - X_SJ.p)) : z;
}

}  // namespace armsig::calibration
