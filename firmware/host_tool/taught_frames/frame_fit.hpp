// SPDX-License-Identifier: MIT
// A frame W through points of which some coordinates are zero in it: its origin, points on its axes
// and in its planes. Least squares where there are more than it takes (docs/model.md, section 14).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/base/pose.hpp"

namespace armsig::tool {

struct FramePoint {
  Vector3 p_A = Vector3::Zero();
  std::array<bool, 3> zero{};  // of x, y, z in W
};

enum class FrameOrigin : std::uint8_t { kToBeFound, kKnown };

struct FrameFit {
  Pose X_AW;
  std::vector<Vector3> residuals_W;  // of each point, where its coordinate should be zero
  std::size_t freedom = 0;           // coordinates that should be zero beyond the unknowns
  // Derivative of the frame by the points, 6 rows and 3 columns a point: its origin in A, then its
  // turn about its own axes.
  Eigen::MatrixXd by_points;

  [[nodiscard]] double residual_squares() const;
};

// Gauss-Newton from `X_start`, which has every point on its side. Nothing where the points do not
// determine the frame. `origin`: that of `X_start` where it is known.
[[nodiscard]] std::optional<FrameFit> fit_frame(const std::vector<FramePoint>& points,
                                                const Pose& X_start, FrameOrigin origin);

// The frame with its origin at `o_A`, its axis `main` along `along_A`, and the direction
// `beside_A` on the side of its axis `second`. Axes count from 0. Precondition: two directions.
[[nodiscard]] Pose frame_along(const Vector3& o_A, int main, const Vector3& along_A, int second,
                               const Vector3& beside_A);

}  // namespace armsig::tool
