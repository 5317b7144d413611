// SPDX-License-Identifier: MIT
// The point that a set of spheres (receivers and ranges) meets in, least squares.
#pragma once

#include "core/base/flight_time.hpp"
#include "core/base/pose.hpp"

namespace armsig::measurement {

// One receiver's statement: the target is `radius_m` from `centre_S`, give or take `sigma_m` > 0.
struct Sphere {
  Vector3 centre_S = Vector3::Zero();
  double radius_m = 0;
  double sigma_m = 0;
};
using Spheres = FixedVector<Sphere, kMaxReceivers>;

struct PointFit {
  Vector3 p_S = Vector3::Zero();
  Matrix3 covariance_m2 = Matrix3::Zero();  // (J^T W J)^-1; only if determined
  double chi_square = 0;                    // sum of ((radius - distance) / sigma)^2
  bool determined = false;  // converged, and the ranges fix the point well enough to linearise
};

// The minima of chi-square on either side of the plane that fits the receivers best: two, or one
// where both searches end in the same point. At least three spheres, all finite.
//
// Start: differences of the squared ranges are linear in the point and give its components in that
// plane, their mean gives the distance from the centroid of the receivers, and so the height above
// the plane but for its sign. For exact ranges one of the two starts is the solution, whatever the
// receivers' arrangement. Then Levenberg-Marquardt, whose damping vanishes (Gauss-Newton) except
// where the equations are nearly singular. A search whose chi-square no noise explains (above
// 1,000) ends where it stops improving: only the order of magnitude of that chi-square is right.
//
// `determined` asks that a 1-sigma error of the point in its worst direction changes no range, by
// the curvature of its sphere, by more than a tenth of its sigma or so: else the covariance would
// be untrue, and a point next to the plane of a flat array could as well be on its other side.
[[nodiscard]] FixedVector<PointFit, 2> fit_point(const Spheres& spheres);

}  // namespace armsig::measurement
