// SPDX-License-Identifier: MIT
// Poses of a flange that touch what a test asks for.
#pragma once

#include <random>

#include "core/base/pose.hpp"
#include "core/numerics/rotations.hpp"

namespace armsig::taught {

inline Vector3 any_vector(std::mt19937& random, double sigma) {
  std::normal_distribution<double> normal(0, sigma);
  return {normal(random), normal(random), normal(random)};
}

inline Matrix3 any_rotation(std::mt19937& random, double sigma_rad) {
  return numerics::rotation_by(any_vector(random, sigma_rad));
}

// KUKA's A, B, C in degrees.
inline Matrix3 by_abc(double a, double b, double c) {
  return rotation_z(radians(a)) * rotation_about(Vector3::UnitY(), radians(b)) *
         rotation_x(radians(c));
}

// The flange of orientation R_CE whose point t_E is at p_C.
inline Pose flange_at(const Matrix3& R_CE, const Vector3& t_E, const Vector3& p_C) {
  return {R_CE, p_C - R_CE * t_E};
}

// The pose moved by 6 numbers: its origin, then its turn about the axes of C.
inline Pose moved_pose(const Pose& X_CE, Eigen::Index number, double by) {
  Pose X = X_CE;
  if (number < 3) {
    X.p[number] += by;
  } else {
    X.R = numerics::rotation_by(by * Vector3::Unit(number - 3)) * X.R;
  }
  return X;
}

}  // namespace armsig::taught
