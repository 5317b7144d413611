// SPDX-License-Identifier: MIT
// The plane of rotation, (13) of the paper: z = a1 x + a2 y + a3.
#pragma once

#include "core/base/error.hpp"
#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

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

}  // namespace armsig::features
