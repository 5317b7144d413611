// SPDX-License-Identifier: MIT
#include "core/features/centre_of_rotation.hpp"

#include <cmath>

namespace armsig::features {

namespace {

// w = |p|^2 - (n.p)^2 as a combination of the geometry's columns.
GeometryFactor::Row squared_distance_in_plane(const Vector3& n) {
  GeometryFactor::Row w;
  w << 0, 0, 0, 0, 1 - n.x() * n.x(), -2 * n.x() * n.y(), -2 * n.x() * n.z(), 1 - n.y() * n.y(),
      -2 * n.y() * n.z(), 1 - n.z() * n.z();
  return w;
}

}  // namespace

Result<CentreOfRotation> centre_of_rotation(const GeometryFactor::Matrix& geometry,
                                            const PlaneOfRotation& plane) {
  const Vector3 ex = any_perpendicular(plane.normal_S);
  const Vector3 ey = plane.normal_S.cross(ex);
  const GeometryFactor::Row w = geometry * squared_distance_in_plane(plane.normal_S);
  SquareRootRls<3, 1> regression;
  for (int row = 0; row < 4; ++row) {
    const Vector3 p = geometry.block<1, 3>(row, 1).transpose();
    regression.update({geometry(row, 0), ex.dot(p), ey.dot(p)},
                      Eigen::Matrix<double, 1, 1>(w[row]));
  }
  if (regression.rank() < 3) return std::unexpected(Error::kSingular);
  const Vector3 a = regression.solve();  // constant, x, y

  const double cx = a[1] / 2;
  const double cy = a[2] / 2;
  CentreOfRotation result;
  result.centre = cx * ex + cy * ey + plane.distance_m * plane.normal_S;
  result.radius_m = std::sqrt(a[0] + cx * cx + cy * cy);
  return result;
}

double circle_residual_squares(const GeometryFactor::Matrix& geometry, const Vector3& normal,
                               const CentreOfRotation& circle) {
  const Vector3 c = circle.centre - normal.dot(circle.centre) * normal;
  GeometryFactor::Row combination = squared_distance_in_plane(normal);
  combination[0] = c.squaredNorm() - circle.radius_m * circle.radius_m;
  combination.segment<3>(1) = -2 * c;
  return (geometry * combination).squaredNorm();
}

}  // namespace armsig::features
