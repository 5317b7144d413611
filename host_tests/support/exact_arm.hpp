// SPDX-License-Identifier: MIT
// An independent, exact arm for tests: the Denavit-Hartenberg product in extended precision, and
// the features that perfect sweeps of it would give.
#pragma once

#include <cmath>
#include <cstddef>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "core/features/feature.hpp"
#include "host_tests/support/random.hpp"

namespace armsig::test {

// 64-bit mantissa on x86-64; elsewhere it may be no more than double.
using Long = long double;
using LongVector3 = Eigen::Matrix<Long, 3, 1>;

inline PoseT<Long> dh_transform(const DhJoint& row, double reading) {
  const bool revolute = row.type == JointType::kRevolute;
  const Long theta = static_cast<Long>(row.theta_rad) + static_cast<Long>(revolute ? reading : 0.0);
  const Long d = static_cast<Long>(row.d_m) + static_cast<Long>(revolute ? 0.0 : reading);
  const Long ct = std::cos(theta);
  const Long st = std::sin(theta);
  const Long ca = std::cos(static_cast<Long>(row.alpha_rad));
  const Long sa = std::sin(static_cast<Long>(row.alpha_rad));
  PoseT<Long> X;
  X.R << ct, -st * ca, st * sa, st, ct * ca, -ct * sa, 0, sa, ca;
  X.p << static_cast<Long>(row.a_m) * ct, static_cast<Long>(row.a_m) * st, d;
  return X;
}

// Pose of Denavit-Hartenberg frame `link` in the frame that X_S0 is given in.
template <typename Rows>
PoseT<Long> dh_pose(const Rows& rows, const JointVector& q, std::size_t link, const Pose& X_S0) {
  PoseT<Long> X{X_S0.R.cast<Long>(), X_S0.p.cast<Long>()};
  for (std::size_t i = 0; i < link; ++i) X = X * dh_transform(rows[i], q[i]);
  return X;
}

inline Pose rounded(const PoseT<Long>& X) { return {X.R.cast<double>(), X.p.cast<double>()}; }

// The same product in plain double precision, as a controller multiplies it out.
template <typename Rows>
Pose plain_dh_pose(const Rows& rows, const JointVector& q, std::size_t link, const Pose& X_S0) {
  Pose X = X_S0;
  for (std::size_t i = 0; i < link; ++i) {
    const bool revolute = rows[i].type == JointType::kRevolute;
    const Matrix3 R_theta = rotation_z(rows[i].theta_rad + (revolute ? q[i] : 0.0));
    const double d_m = rows[i].d_m + (revolute ? 0.0 : q[i]);
    X = X * Pose{R_theta * rotation_x(rows[i].alpha_rad), R_theta * Vector3(rows[i].a_m, 0, d_m)};
  }
  return X;
}

// An arm standing at X_S0, held in configuration `q_s`, with a target fixed to its last link.
struct ExactArm {
  Arm arm;
  JointVector q_s;
  Pose X_S0;
  Vector3 p_F = Vector3(0.11, 0.07, 0.05);  // the target, in Denavit-Hartenberg frame n

  [[nodiscard]] std::size_t count() const { return arm.joints.size(); }
  [[nodiscard]] Pose tool_pose(const JointVector& q) const {
    return rounded(dh_pose(arm.joints, q, count(), X_S0));
  }
  [[nodiscard]] LongVector3 target(const JointVector& q) const {
    return dh_pose(arm.joints, q, count(), X_S0) * LongVector3(p_F.cast<Long>());
  }
};

// What an exact sweep of joint `joint` says when it starts at `first_reading`: the axis by the
// product, centre and radius by dropping a perpendicular from the target.
inline features::JointFeature exact_feature(const ExactArm& exact, std::size_t joint,
                                            double first_reading) {
  JointVector q = exact.q_s;
  q[joint] = first_reading;
  const PoseT<Long> X_SF = dh_pose(exact.arm.joints, exact.q_s, joint, exact.X_S0);
  const LongVector3 axis = X_SF.R.col(2);
  const LongVector3 first = exact.target(q);
  features::JointFeature feature;
  feature.type = exact.arm.joints[joint].type;
  feature.axis_S = axis.cast<double>();
  feature.reference_reading = first_reading;
  if (feature.type == JointType::kPrismatic) {
    feature.point_S = first.cast<double>();
    feature.radial_S = any_perpendicular(feature.axis_S);
    return feature;
  }
  const LongVector3 centre = X_SF.p + axis * axis.dot(first - X_SF.p);
  const LongVector3 radial = first - centre;
  feature.point_S = centre.cast<double>();
  feature.radius_m = static_cast<double>(radial.norm());
  feature.radial_S = radial.normalized().cast<double>();
  return feature;
}

inline FixedVector<features::JointFeature, kMaxJoints> exact_features(const ExactArm& exact) {
  FixedVector<features::JointFeature, kMaxJoints> features;
  for (std::size_t i = 0; i < exact.count(); ++i) {
    features.push_back(exact_feature(exact, i, exact.q_s[i] - 0.3));
  }
  return features;
}

// 1 to 8 joints, a quarter of them prismatic; twists among the usual right angles, exactly parallel
// and antiparallel, slightly off parallel, and any; a and d often zero, so that axes also meet.
inline Arm random_arm(Random& random) {
  Arm arm;
  const std::size_t n = 1 + random.index(kMaxJoints);
  for (std::size_t i = 0; i < n; ++i) {
    DhJoint row;
    row.type = random.index(4) == 0 ? JointType::kPrismatic : JointType::kRevolute;
    row.theta_rad = random.uniform(-kPi, kPi);
    row.d_m = random.index(3) == 0 ? 0.0 : random.uniform(-0.5, 0.5);
    row.a_m = random.index(3) == 0 ? 0.0 : random.uniform(-0.5, 0.5);
    switch (random.index(6)) {
      case 0:
        row.alpha_rad = 0.0;
        break;
      case 1:
        row.alpha_rad = kPi;
        break;
      case 2:
        row.alpha_rad = kPi / 2;
        break;
      case 3:
        row.alpha_rad = random.uniform(-2e-3, 2e-3);
        break;
      case 4:
        row.alpha_rad = -kPi / 2 + random.uniform(-2e-3, 2e-3);
        break;
      default:
        row.alpha_rad = random.uniform(-kPi, kPi);
    }
    arm.joints.push_back(row);
    arm.limits.push_back({-kPi, kPi});
  }
  return arm;
}

}  // namespace armsig::test
