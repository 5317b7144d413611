// SPDX-License-Identifier: MIT
#include "core/features/centre_of_rotation.hpp"

#include <cmath>

namespace armsig::features {

GeometryFactor::Row squared_distance_in_plane(const PlaneOfRotation& plane) {
  const Vector3& n = plane.normal_S;
  // Of the six products that of z is |p|^2 less the two others.
  const double zz = 1 - n.z() * n.z();
  GeometryFactor::Row w;
  w << 0, 0, 0, 0, zz, 1 - n.x() * n.x() - zz, -2 * n.x() * n.y(), -2 * n.x() * n.z(),
      1 - n.y() * n.y() - zz, -2 * n.y() * n.z();
  return w;
}

// With n.p = d + h, h the distance from the plane: (n.p)^2 = 2 d n.p - d^2 + h^2.
GeometryFactor::Row squared_distance_near_plane(const PlaneOfRotation& plane) {
  const double d = plane.distance_m;
  GeometryFactor::Row w = GeometryFactor::Row::Zero();
  w[0] = d * d;
  w.segment<3>(1) = -2 * d * plane.normal_S;
  w[4] = 1;
  return w;
}

Result<CentreOfRotation> centre_of_rotation(const GeometryFactor::Matrix& geometry,
                                            const PlaneOfRotation& plane,
                                            const GeometryFactor::Row& squared_distance) {
  const Vector3 ex = any_perpendicular(plane.normal_S);
  const Vector3 ey = plane.normal_S.cross(ex);
  const GeometryFactor::Row w = geometry * squared_distance;
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
  // The regressors are zero in the rows that follow.
  result.residual_squares = regression.residual_products()(0, 0) + w.tail<6>().squaredNorm();
  return result;
}

}  // namespace armsig::features
