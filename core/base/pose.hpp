// SPDX-License-Identifier: MIT
// Rigid transforms in monogram notation: X_AB is the pose of frame B in frame A, so that X_AC =
// X_AB * X_BC.
#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/Geometry>

// Eigen aligns by the flags of the build; what is passed to the library must not depend on them.
static_assert(
    EIGEN_MAX_STATIC_ALIGN_BYTES == 16,
    "define EIGEN_MAX_ALIGN_BYTES=16 wherever Eigen is included (the CMake package does)");

namespace armsig {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

inline constexpr double kPi = std::numbers::pi;
[[nodiscard]] constexpr double radians(double degrees) { return degrees * (kPi / 180.0); }
[[nodiscard]] constexpr double degrees(double radians) { return radians * (180.0 / kPi); }

// The angle in (-pi, pi] that differs from `angle_rad` by whole turns.
[[nodiscard]] inline double wrap_angle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * kPi);
  return wrapped == -kPi ? kPi : wrapped;
}

// Pose of frame B in frame A: p_A = R_AB * p_B + p_AB. Lengths in metres.
template <typename Scalar>
struct PoseT {
  Eigen::Matrix<Scalar, 3, 3> R = Eigen::Matrix<Scalar, 3, 3>::Identity();
  Eigen::Matrix<Scalar, 3, 1> p = Eigen::Matrix<Scalar, 3, 1>::Zero();

  [[nodiscard]] PoseT operator*(const PoseT& X_BC) const { return {R * X_BC.R, R * X_BC.p + p}; }
  [[nodiscard]] Eigen::Matrix<Scalar, 3, 1> operator*(
      const Eigen::Matrix<Scalar, 3, 1>& p_B) const {
    return R * p_B + p;
  }
  [[nodiscard]] PoseT inverse() const { return {R.transpose(), -(R.transpose() * p)}; }
};
using Pose = PoseT<double>;

// Elementary rotations, Rot(z, angle) and Rot(x, angle) of the paper.
[[nodiscard]] inline Matrix3 rotation_z(double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return Matrix3{{c, -s, 0}, {s, c, 0}, {0, 0, 1}};
}
[[nodiscard]] inline Matrix3 rotation_x(double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return Matrix3{{1, 0, 0}, {0, c, -s}, {0, s, c}};
}

// The skew-symmetric matrix with cross_matrix(v) * w = v x w.
[[nodiscard]] inline Matrix3 cross_matrix(const Vector3& v) {
  return Matrix3{{0, -v.z(), v.y()}, {v.z(), 0, -v.x()}, {-v.y(), v.x(), 0}};
}

// Rotation about the unit vector `axis` (Rodrigues).
[[nodiscard]] inline Matrix3 rotation_about(const Vector3& axis, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
}

// The rotation vector (axis times angle, angle in [0, pi]) of R; exact to rounding for small angles
// too.
[[nodiscard]] Vector3 rotation_vector(const Matrix3& R);

// The angle between two rotations, in [0, pi]; accurate to rounding near zero, where an arc cosine
// is not.
[[nodiscard]] double angle_between(const Matrix3& R_WA, const Matrix3& R_WB);

// Some unit vector perpendicular to the unit vector `v`, well conditioned for any v.
[[nodiscard]] Vector3 any_perpendicular(const Vector3& v);

}  // namespace armsig
