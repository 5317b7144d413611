// SPDX-License-Identifier: MIT
// Where searches for a rotation begin.
#pragma once

#include <array>

#include "core/base/pose.hpp"

namespace armsig::calibration {

// The 24 rotations of a cube: signed permutations of the axes that do not mirror. No rotation is
// further than 63 degrees from one of them.
template <typename Visit>
void for_each_cube_rotation(Visit visit) {
  constexpr std::array<std::array<int, 3>, 6> kOrders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}}};
  for (const std::array<int, 3>& order : kOrders) {
    for (int signs = 0; signs < 8; ++signs) {
      Matrix3 R = Matrix3::Zero();
      for (int c = 0; c < 3; ++c) {
        R(order[static_cast<std::size_t>(c)], c) = (signs >> c) % 2 == 0 ? 1 : -1;
      }
      if (R.determinant() > 0) visit(R);
    }
  }
}

}  // namespace armsig::calibration
