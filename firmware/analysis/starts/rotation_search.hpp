// SPDX-License-Identifier: MIT
// Base rotation and target of an arm known by its drawing, from moments of the log alone.
//
// p_k = R (t_k + R_k u) + s, with t_k, R_k the pose of the last link in the base. About the means s
// is gone, and with g_k = (t_k, columns of R_k) the sum of squares is a function of R, u and the
// second moments of p and g: one evaluation costs the same for ten rows and ten thousand.
#pragma once

#include "core/base/pose.hpp"

namespace armsig::calibration {

using Vector12 = Eigen::Matrix<double, 12, 1>;

// Weighted moments of rows about their means.
struct Moments {
  double weight = 0;
  Vector3 mean_p = Vector3::Zero();
  Vector12 mean_g = Vector12::Zero();
  double pp = 0;
  Eigen::Matrix<double, 3, 12> pg = Eigen::Matrix<double, 3, 12>::Zero();
  Eigen::Matrix<double, 12, 12> gg = Eigen::Matrix<double, 12, 12>::Zero();

  // Incremental (Welford), so that a base metres away costs no digits.
  void add(const Vector3& p, const Vector12& g, double w);
};

// t + R u, from g = (t, columns of R).
[[nodiscard]] Vector3 combined(const Vector12& g, const Vector3& u);

struct Candidate {
  Matrix3 R = Matrix3::Identity();
  Vector3 u = Vector3::Zero();
};

// The nearest minimum: Levenberg-Marquardt on (R, u). Returns its sum of squares.
double polish(const Moments& moments, Candidate& candidate);

// The best minimum found from the rotations of a cube, each with its best u.
[[nodiscard]] Candidate search(const Moments& moments);

}  // namespace armsig::calibration
