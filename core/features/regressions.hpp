// SPDX-License-Identifier: MIT
// The paper's regressions (section 3.1), from the geometry of the points alone.
#pragma once

#include "core/base/error.hpp"
#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

// The plane of rotation, (13): z = a1 x + a2 y + a3.
struct PlaneOfRotation {
  Vector3 normal_S = Vector3::UnitZ();  // unit; its sense is not told by a plane
  double distance_m = 0;  // normal_S . p of its points, p about the statistics' origin
};

// As printed, (13) is singular for a plane that contains the sensor's z axis. Here the regressed
// coordinate is the one that leaves the two others spread over the greatest area, which is the one
// nearest to the normal. (Not simply the one that spreads least itself: along a short arc all three
// spread with the chord, and the least of them may lie in the plane.)
// Errors: kSingular (the points lie on one line).
[[nodiscard]] Result<PlaneOfRotation> plane_of_rotation(const Geometry& geometry);

// Weighted sum of squares of the points' distances from the plane.
[[nodiscard]] double plane_residual_squares(const Geometry& geometry, const PlaneOfRotation& plane);

// The centre of rotation, (14): w = a1 x + a2 y + a3, with x, y the coordinates in the plane of
// rotation and w = x^2 + y^2.
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

// The line of translation of a prismatic joint, section 3.1: the line that the target traces.
struct LineOfTranslation {
  Vector3 direction_S = Vector3::UnitZ();  // unit; its sense is not told by a line
  Vector3 mean = Vector3::Zero();  // of the points, about the statistics' origin: on the line
};

// Two regressions, y = a1 x + a2 and z = b1 x + b2, with x the coordinate along which the points
// spread most.
// Errors: kSingular (the points coincide).
[[nodiscard]] Result<LineOfTranslation> line_of_translation(const Geometry& geometry);

}  // namespace armsig::features
