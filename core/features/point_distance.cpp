// SPDX-License-Identifier: MIT
#include "core/features/point_distance.hpp"

namespace armsig::features {

// By the adjugate.
double chi_square(const Vector3& r, const Matrix3& covariance) {
  // Scaled, because variances of exact data are near 1e-30 and their determinant would underflow.
  const double scale = 1 / covariance.trace();
  const double xx = scale * covariance(0, 0);
  const double xy = scale * covariance(0, 1);
  const double xz = scale * covariance(0, 2);
  const double yy = scale * covariance(1, 1);
  const double yz = scale * covariance(1, 2);
  const double zz = scale * covariance(2, 2);
  const double a = yy * zz - yz * yz;
  const double b = yz * xz - xy * zz;
  const double c = xy * yz - yy * xz;
  const double d = xx * zz - xz * xz;
  const double e = xy * xz - xx * yz;
  const double f = xx * yy - xy * xy;
  const double determinant = xx * a + xy * b + xz * c;
  const double squares = r[0] * r[0] * a + r[1] * r[1] * d + r[2] * r[2] * f;
  const double mixed = r[0] * r[1] * b + r[0] * r[2] * c + r[1] * r[2] * e;
  return (squares + 2 * mixed) * scale / determinant;
}

}  // namespace armsig::features
