// SPDX-License-Identifier: MIT
#include "core/features/plane_of_rotation.hpp"

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

}  // namespace armsig::features
