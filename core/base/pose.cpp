// SPDX-License-Identifier: MIT
#include "core/base/pose.hpp"

namespace armsig {

Vector3 rotation_vector(const Matrix3& R) {
  // By way of the quaternion: its vector part keeps full relative precision for small angles, and
  // its construction from a matrix chooses the largest component, so that angles near pi are safe
  // as well.
  Eigen::Quaterniond q(R);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double s = q.vec().norm();
  if (s == 0) return Vector3::Zero();
  return q.vec() * (2.0 * std::atan2(s, q.w()) / s);
}

double angle_between(const Matrix3& R_WA, const Matrix3& R_WB) {
  return rotation_vector(R_WA.transpose() * R_WB).norm();
}

Vector3 any_perpendicular(const Vector3& v) {
  int smallest = 0;
  v.cwiseAbs().minCoeff(&smallest);
  return v.cross(Vector3::Unit(smallest)).normalized();
}

}  // namespace armsig
