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
};

// The paper projects the points onto the plane and fits the circle to the projections; because
// w = |p|^2 - (n.p)^2 is linear in the monomials of p, the same fit comes from the statistics,
// without the points.
// Errors: kSingular (the projections lie on one line).
[[nodiscard]] Result<CentreOfRotation> centre_of_rotation(const GeometryFactor::Matrix& geometry,
                                                          const PlaneOfRotation& plane);

// Weighted sum of squares of w - (2 c.p + r^2 - |c|^2) over all points, all in the plane: each is
// 2 r times the point's radial distance from the circle, to first order.
[[nodiscard]] double circle_residual_squares(const GeometryFactor::Matrix& geometry,
                                             const Vector3& normal, const CentreOfRotation& circle);

}  // namespace armsig::features
