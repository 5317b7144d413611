// SPDX-License-Identifier: MIT
// The three-dimensional grid of section 4 of the paper, in a workspace frame W taught by three
// points.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/fixed_vector.hpp"
#include "core/base/pose.hpp"

namespace armsig::evaluation {

inline constexpr std::size_t kMaxVertices = 512;

// A box of vertices, evenly spaced; at least two along each axis and at most kMaxVertices in all.
struct Grid {
  std::array<double, 3> size_m{0.25, 0.25, 0.60};  // the paper's 25 cm by 25 cm by 60 cm
  std::array<std::size_t, 3> count{6, 6,
                                   7};  // vertices along each axis: every 5 cm, 5 cm and 10 cm

  [[nodiscard]] std::size_t vertex_count() const { return count[0] * count[1] * count[2]; }
  [[nodiscard]] std::size_t index(std::size_t i, std::size_t j, std::size_t k) const {
    return (k * count[1] + j) * count[0] + i;
  }
  // Position of vertex (i, j, k) in W: the grid starts at W's origin.
  [[nodiscard]] Vector3 vertex(std::size_t i, std::size_t j, std::size_t k) const {
    const auto at = [&](std::size_t axis, std::size_t n) {
      return size_m[axis] * static_cast<double>(n) / static_cast<double>(count[axis] - 1);
    };
    return {at(0, i), at(1, j), at(2, k)};
  }
};

// The frame that three taught points define: origin at the first, x towards the second, the third
// in its xy plane on the side of positive y. Precondition: the points are not on one line.
[[nodiscard]] inline Pose taught_frame(const Vector3& p_origin, const Vector3& p_x,
                                       const Vector3& p_xy) {
  const Vector3 x = (p_x - p_origin).normalized();
  const Vector3 z = x.cross(p_xy - p_origin).normalized();
  Pose X_FW;
  X_FW.R << x, z.cross(x), z;
  X_FW.p = p_origin;
  return X_FW;
}

}  // namespace armsig::evaluation
