// SPDX-License-Identifier: MIT
// Circles and lines of known truth, and random numbers to place and to measure them with.
#pragma once

#include <cmath>
#include <cstddef>

#include "core/features/feature.hpp"
#include "core/features/sweep_estimator.hpp"
#include "host_tests/support/random.hpp"

namespace armsig::test {

// Noise of each coordinate in the sweeps of tests.
inline constexpr double kSweepSigma_m = 0.2e-3;

// The true motion of a target: about a circle, or along R_SC's third column where the radius is 0.
struct TrueMotion {
  JointType type = JointType::kRevolute;
  Vector3 point_S = Vector3::Zero();  // centre; prismatic: the target at the first reading
  Matrix3 R_SC = Matrix3::Identity();
  double radius_m = 0;
  double first_reading = 0;

  [[nodiscard]] Vector3 at(double reading) const {
    const double t = reading - first_reading;
    if (type == JointType::kPrismatic) return point_S + t * R_SC.col(2);
    return point_S + radius_m * (std::cos(t) * R_SC.col(0) + std::sin(t) * R_SC.col(1));
  }
};

inline TrueMotion random_motion(JointType type, Random& random, double least_radius = 0.3) {
  TrueMotion motion;
  motion.type = type;
  motion.point_S = Vector3(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 2.5);
  const Vector3 axis = random.direction();
  const Vector3 radial = axis.cross(random.direction()).normalized();
  motion.R_SC << radial, axis.cross(radial), axis;
  motion.radius_m = type == JointType::kRevolute ? random.uniform(least_radius, 0.8) : 0;
  motion.first_reading = random.uniform(-3, 3);
  return motion;
}

// The i-th of n readings spread evenly over `range`, the first being first_reading.
inline double even_reading(const TrueMotion& motion, double range, std::size_t i, std::size_t n) {
  return motion.first_reading + range * static_cast<double>(i) / static_cast<double>(n - 1);
}

// Estimate minus truth: (point, rotation vector of the triad, radius). The triad of the estimate is
// carried to the first reading of the truth.
inline Eigen::Matrix<double, 7, 1> feature_error(const features::JointFeature& feature,
                                                 const TrueMotion& truth) {
  const double back = truth.first_reading - feature.reference_reading;
  const Vector3 across = feature.axis_S.cross(feature.radial_S);
  Eigen::Matrix<double, 7, 1> error;
  if (truth.type == JointType::kPrismatic) {
    const Vector3 tilt = truth.R_SC.col(2).cross(feature.axis_S);
    error << feature.point_S - truth.at(feature.reference_reading), tilt, 0;
    return error;
  }
  Matrix3 R_SE;
  R_SE << feature.radial_S, across, feature.axis_S;
  R_SE = R_SE * rotation_z(back);
  error << feature.point_S - truth.point_S, rotation_vector(R_SE * truth.R_SC.transpose()),
      feature.radius_m - truth.radius_m;
  return error;
}

inline Matrix3 isotropic(double sigma_m) { return sigma_m * sigma_m * Matrix3::Identity(); }

}  // namespace armsig::test
