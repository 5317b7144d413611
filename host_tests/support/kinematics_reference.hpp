// SPDX-License-Identifier: MIT
// Forward kinematics written out as (1) and (2), 4 x 4 matrix by matrix, in extended precision: the
// reference that the servo's kernels are judged by.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "core/base/arm.hpp"

namespace armsig::test {

using Matrix4L = std::array<std::array<long double, 4>, 4>;

inline Matrix4L dh_matrix(const DhJoint& row, long double reading) {
  const bool revolute = row.type == JointType::kRevolute;
  const long double theta = static_cast<long double>(row.theta_rad) + (revolute ? reading : 0);
  const long double d = static_cast<long double>(row.d_m) + (revolute ? 0 : reading);
  const long double a = static_cast<long double>(row.a_m);
  const long double alpha = static_cast<long double>(row.alpha_rad);
  const long double c = std::cos(theta);
  const long double s = std::sin(theta);
  const long double ca = std::cos(alpha);
  const long double sa = std::sin(alpha);
  return {{{c, -s * ca, s * sa, a * c}, {s, c * ca, -c * sa, a * s}, {0, sa, ca, d}, {0, 0, 0, 1}}};
}

// T = A_1 ... A_n of (1).
inline Matrix4L reference_pose(const DhRows& rows, const JointVector& q) {
  Matrix4L T{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
  for (std::size_t joint = 0; joint < rows.size(); ++joint) {
    const Matrix4L A = dh_matrix(rows[joint], static_cast<long double>(q[joint]));
    Matrix4L product{};
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = 0; c < 4; ++c) {
        for (std::size_t k = 0; k < 4; ++k) product[r][c] += T[r][k] * A[k][c];
      }
    }
    T = product;
  }
  return T;
}

}  // namespace armsig::test
