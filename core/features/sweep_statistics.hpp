// SPDX-License-Identifier: MIT
// What is kept of a sweep, however long: the constant-size sufficient statistics of its points.
//
// Two triangular factors, both about a point of the sweep, so that a sensor metres away and
// readings of thousands of turns cost no digits:
//   motion    p on [1, sin t, 1 - cos t] (revolute) or [1, t] (prismatic), t the reading moved:
//             the encoder-referenced circle p = c + A cos t + B sin t, (M3) of docs/model.md,
//             written c + A, B, -A so that a short arc has well-scaled columns; or the line
//             c + u t;
//   geometry  the quadratic monomials on [1 x y z]: the plane (13) with any pivot, and the circle
//             (14) in any plane, because w = |p|^2 - (n.p)^2 is linear in the monomials.
// The geometry is kept for the paper's method alone. Of the encoder's the motion tells how far the
// points are from a plane, and with |p|^2 as one more right-hand side how far from a circle.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "core/features/feature.hpp"
#include "core/features/rls.hpp"

namespace armsig::features {

// One measured point of a sweep.
struct SweepPoint {
  double reading = 0;             // radians or metres
  Vector3 p_S = Vector3::Zero();  // metres
  Matrix3 covariance_m2;          // of p_S; unset until it is measured
  // Mean variance per axis.
  [[nodiscard]] double variance() const { return covariance_m2.trace() / 3; }
};

using MotionRls = SquareRootRls<3, 3>;
// |p|^2, xx, xy, xz, yy, yz on 1, x, y, z.
using Geometry = SquareRootRls<4, 6>;

// Whether not a bit is different.
[[nodiscard]] bool same_bits(const Matrix3& a, const Matrix3& b);

// The inverse of a covariance by elimination: L^-T W L^-1, L with a unit diagonal, W diagonal.
struct Information {
  double l10 = 0;
  double l20 = 0;
  double l21 = 0;
  Vector3 w = Vector3::Ones();

  Information() = default;
  // Reads the lower triangle.
  explicit Information(const Matrix3& covariance);

  [[nodiscard]] bool is_positive_definite() const { return w.allFinite() && w.minCoeff() > 0; }
  // r^T covariance^-1 r.
  [[nodiscard]] double chi_square(const Vector3& r) const {
    const double y = r[1] - l10 * r[0];
    const double z = r[2] - l20 * r[0] - l21 * y;
    return w[0] * r[0] * r[0] + w[1] * y * y + w[2] * z * z;
  }
};

// The regressors of the motion; a prismatic joint has two, and leaves the third zero.
[[nodiscard]] Vector3 motion_regressors(JointType type, double moved);
[[nodiscard]] constexpr int motion_unknowns(JointType type) {
  return type == JointType::kRevolute ? 3 : 2;
}

// The variance that rounding alone may give a coordinate of this point, 16 units in the last place:
// of the coordinates themselves, and of the reading at the speed with which it moves the point.
[[nodiscard]] double rounding_variance(const SweepPoint& point, double speed);

// A point beside those before it, as if it were one of them.
struct Trial {
  Vector3 regressors;
  MotionRls::Rotations rotations;
  bool has_first_covariance;  // that of all before it

  [[nodiscard]] const MotionRls::Innovation& innovation() const { return rotations.innovation; }
};

// What the encoder-referenced fits need of a sweep. Every point enters with the weight 1 /
// variance(); plain data, may be copied and logged whole.
struct MotionStatistics {
  JointType type = JointType::kRevolute;
  double origin_reading = 0;
  Vector3 origin_S = Vector3::Zero();
  std::size_t count = 0;
  double lowest_reading = 0;
  double highest_reading = 0;
  MotionRls motion;
  double variance_sum = 0;  // of variance()
  // Of the first point, and how many of the first points have that very covariance. As long as all
  // have, the two sums below are not kept: they follow from it and the factor.
  Matrix3 first_covariance_m2 = Matrix3::Identity();
  Information first_information;  // its inverse
  std::size_t same_covariance = 0;
  Matrix3 shape_sum = Matrix3::Zero();  // of covariance / variance()
  // Sum of weight * (products of the regressors) (products of covariance / variance())^T, each in
  // the order 00 01 02 11 12 22: what score_covariance() is made of.
  Eigen::Matrix<double, 6, 6> score_sum = Eigen::Matrix<double, 6, 6>::Zero();

  MotionStatistics() = default;
  MotionStatistics(JointType joint, const SweepPoint& origin)
      : type(joint), origin_reading(origin.reading), origin_S(origin.p_S) {}

  void add(const SweepPoint& point) { add(point, tried(point)); }
  // Precondition: `trial` is of this point, by these statistics.
  void add(const SweepPoint& point, const Trial& trial);
  // Precondition: there is an origin.
  [[nodiscard]] Trial tried(const SweepPoint& point) const;

  [[nodiscard]] double arc() const { return highest_reading - lowest_reading; }
  [[nodiscard]] Vector3 regressors(const SweepPoint& point) const {
    return motion_regressors(type, point.reading - origin_reading);
  }
  [[nodiscard]] bool has_one_covariance() const { return same_covariance == count; }
  // The mean covariance of a point over its mean variance per axis (trace 3).
  [[nodiscard]] Matrix3 shape() const;
  // Sum of weight * regressors regressors^T (x) covariance / variance(): the covariance of the
  // score of the motion fit, true also where the covariance changes along the sweep.
  [[nodiscard]] Eigen::Matrix<double, 9, 9> score_covariance() const;
  [[nodiscard]] double mean_variance() const { return variance_sum / static_cast<double>(count); }
  // Residuals left over by the motion fit: how many, and their sum of squares, each over its
  // variance along its direction.
  [[nodiscard]] double motion_freedom() const;
  [[nodiscard]] double motion_chi_square() const;

 private:
  void add_covariance(const SweepPoint& point, const Vector3& x);
  [[nodiscard]] Eigen::Matrix<double, 6, 6> score_sums() const;
};

// With the geometry, that of the paper's regressions and of the misfits along and across the plane.
struct SweepStatistics : MotionStatistics {
  Method method = Method::kEncoder;
  Geometry of_points;            // of the paper's method
  MotionRls::Companion squares;  // |p|^2, of the encoder's, of a revolute joint

  SweepStatistics() = default;
  // What is fitted by `by` in the end.
  SweepStatistics(JointType joint, Method by) : MotionStatistics(joint, {}), method(by) {}

  // The first point is the origin.
  void add(const SweepPoint& point);
  void add(const SweepPoint& point, const Trial& trial);
  // Of the encoder's method of 1, x, y, z and |p|^2, the rest zero.
  [[nodiscard]] Geometry geometry() const;
};

}  // namespace armsig::features
