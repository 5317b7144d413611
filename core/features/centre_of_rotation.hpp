// SPDX-License-Identifier: MIT
// The centre of rotation, (14) of the paper: w = a1 x + a2 y + a3, with x, y the coordinates in the
// plane of rotation and w = x^2 + y^2.
#pragma once

#include "core/base/error.hpp"
#include "core/features/plane_of_rotation.hpp"
#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

struct CentreOfRotation {
  Vector3 centre = Vector3::Zero();  // about the statistics' origin, in the sensor frame's axes
  double radius_m = 0;
  // Weighted sum over the points of the squares of w less its regression: each is 2 r times the
  // point's radial distance from the circle, to first order.
  double residual_squares = 0;
};

// w = |p|^2 - (n.p)^2, |p| from the statistics' origin, as a combination of the geometry's columns:
// exact, for statistics of the paper's method; and by the first five columns, off by the square of
// the point's distance from the plane.
using GeometryRow = Eigen::Matrix<double, 10, 1>;
[[nodiscard]] GeometryRow squared_distance_in_plane(const PlaneOfRotation& plane);
[[nodiscard]] GeometryRow squared_distance_near_plane(const PlaneOfRotation& plane);

// The paper projects the points onto the plane and fits the circle to the projections; because
// w = |p|^2 - (n.p)^2 is linear in the monomials of p, the same fit comes from the statistics,
// without the points. `squared_distance`: w.
// Errors: kSingular (the projections lie on one line).
[[nodiscard]] Result<CentreOfRotation> centre_of_rotation(const Geometry& geometry,
                                                          const PlaneOfRotation& plane,
                                                          const GeometryRow& squared_distance);

}  // namespace armsig::features
