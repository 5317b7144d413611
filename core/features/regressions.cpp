// SPDX-License-Identifier: MIT
#include "core/features/regressions.hpp"

#include <cmath>

namespace armsig::features {

Result<PlaneOfRotation> plane_of_rotation(const Geometry& geometry) {
  const Eigen::Matrix4d R = geometry.factor();
  // The lower right corner holds the spread of x, y, z about their mean; the cross product of two
  // columns is the area over which the points spread in these two coordinates.
  const Matrix3 spread = R.bottomRightCorner<3, 3>();
  int pivot = 0;
  double greatest = -1;
  for (int i = 0; i < 3; ++i) {
    const double area = spread.col((i + 1) % 3).cross(spread.col((i + 2) % 3)).squaredNorm();
    if (area > greatest) {
      greatest = area;
      pivot = i;
    }
  }
  const int x = (pivot + 1) % 3;
  const int y = (pivot + 2) % 3;
  SquareRootRls<3, 1> regression;
  for (int row = 0; row < 4; ++row)
    regression.update({R(row, 0), R(row, 1 + x), R(row, 1 + y)},
                      Eigen::Matrix<double, 1, 1>(R(row, 1 + pivot)));
  if (regression.rank() < 3) return std::unexpected(Error::kSingular);
  const Vector3 a = regression.solve();  // constant, slope along x, slope along y

  PlaneOfRotation plane;
  plane.normal_S[pivot] = 1;
  plane.normal_S[x] = -a[1];
  plane.normal_S[y] = -a[2];
  const double length = plane.normal_S.norm();
  plane.normal_S /= length;
  plane.distance_m = a[0] / length;
  return plane;
}

double plane_residual_squares(const Geometry& geometry, const PlaneOfRotation& plane) {
  Eigen::Vector4d combination;
  combination << -plane.distance_m, plane.normal_S;
  return (geometry.factor() * combination).squaredNorm();
}

GeometryRow squared_distance_in_plane(const PlaneOfRotation& plane) {
  const Vector3& n = plane.normal_S;
  // Of the six products that of z is |p|^2 less the two others.
  const double zz = 1 - n.z() * n.z();
  GeometryRow w;
  w << 0, 0, 0, 0, zz, 1 - n.x() * n.x() - zz, -2 * n.x() * n.y(), -2 * n.x() * n.z(),
      1 - n.y() * n.y() - zz, -2 * n.y() * n.z();
  return w;
}

// With n.p = d + h, h the distance from the plane: (n.p)^2 = 2 d n.p - d^2 + h^2.
GeometryRow squared_distance_near_plane(const PlaneOfRotation& plane) {
  const double d = plane.distance_m;
  GeometryRow w = GeometryRow::Zero();
  w[0] = d * d;
  w.segment<3>(1) = -2 * d * plane.normal_S;
  w[4] = 1;
  return w;
}

Result<CentreOfRotation> centre_of_rotation(const Geometry& geometry, const PlaneOfRotation& plane,
                                            const GeometryRow& squared_distance) {
  const Vector3 ex = any_perpendicular(plane.normal_S);
  const Vector3 ey = plane.normal_S.cross(ex);
  const Eigen::Matrix4d R = geometry.factor();
  const Geometry::RightHandSides quadratic = squared_distance.tail<6>();
  const Eigen::Vector4d w =
      R * squared_distance.head<4>() + geometry.rotated_right_hand_sides() * quadratic;
  SquareRootRls<3, 1> regression;
  for (int row = 0; row < 4; ++row) {
    const Vector3 p = R.block<1, 3>(row, 1).transpose();
    regression.update({R(row, 0), ex.dot(p), ey.dot(p)}, Eigen::Matrix<double, 1, 1>(w[row]));
  }
  if (regression.rank() < 3) return std::unexpected(Error::kSingular);
  const Vector3 a = regression.solve();  // constant, x, y

  const double cx = a[1] / 2;
  const double cy = a[2] / 2;
  CentreOfRotation result;
  result.centre = cx * ex + cy * ey + plane.distance_m * plane.normal_S;
  result.radius_m = std::sqrt(a[0] + cx * cx + cy * cy);
  result.residual_squares = regression.residual_products()(0, 0) +
                            quadratic.dot(geometry.residual_products() * quadratic);
  return result;
}

Result<LineOfTranslation> line_of_translation(const Geometry& geometry) {
  const Eigen::Matrix4d R = geometry.factor();
  int x = 0;
  R.bottomRightCorner<3, 3>().colwise().squaredNorm().maxCoeff(&x);
  const int y = (x + 1) % 3;
  const int z = (x + 2) % 3;
  SquareRootRls<2, 2> regression;
  for (int row = 0; row < 4; ++row)
    regression.update({R(row, 0), R(row, 1 + x)}, {R(row, 1 + y), R(row, 1 + z)});
  if (regression.rank() < 2) return std::unexpected(Error::kSingular);
  const Eigen::Matrix2d a = regression.solve();  // rows: constant, slope

  LineOfTranslation line;
  line.direction_S[x] = 1;
  line.direction_S[y] = a(1, 0);
  line.direction_S[z] = a(1, 1);
  line.direction_S.normalize();
  line.mean = R.block<1, 3>(0, 1).transpose() / R(0, 0);
  return line;
}

}  // namespace armsig::features
