// SPDX-License-Identifier: MIT
#include "firmware/analysis/evaluation/fusion.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/base/check.hpp"
#include "core/numerics/rotations.hpp"

namespace armsig::features {
namespace {

using State = Eigen::Matrix<double, 7, 1>;  // errors of a: centre, rotation vector, radius

// RMS over both sets of points.
double combined(double rms_a, std::size_t used_a, double rms_b, std::size_t used_b) {
  const auto na = static_cast<double>(used_a);
  const auto nb = static_cast<double>(used_b);
  return na + nb == 0 ? 0 : std::sqrt((na * rms_a * rms_a + nb * rms_b * rms_b) / (na + nb));
}

SweepQuality fuse_quality(const SweepQuality& a, const SweepQuality& b) {
  SweepQuality q = a;
  q.used = a.used + b.used;
  q.rejected = a.rejected + b.rejected;
  q.lowest_reading = std::min(a.lowest_reading, b.lowest_reading);
  q.highest_reading = std::max(a.highest_reading, b.highest_reading);
  q.rms_normal_m = combined(a.rms_normal_m, a.used, b.rms_normal_m, b.used);
  q.rms_radial_m = combined(a.rms_radial_m, a.used, b.rms_radial_m, b.used);
  q.rms_tangential_m = combined(a.rms_tangential_m, a.used, b.rms_tangential_m, b.used);
  q.sigma_m = combined(a.sigma_m, a.used, b.sigma_m, b.used);
  q.sigma_is_estimated = a.sigma_is_estimated || b.sigma_is_estimated;
  const double weight_a = 1 / (a.encoder_ratio_sigma * a.encoder_ratio_sigma);
  const double weight_b = 1 / (b.encoder_ratio_sigma * b.encoder_ratio_sigma);
  if (std::isfinite(weight_a) && std::isfinite(weight_b)) {
    const double weights = weight_a + weight_b;
    q.encoder_ratio = (weight_a * a.encoder_ratio + weight_b * b.encoder_ratio) / weights;
    q.encoder_ratio_sigma = std::sqrt(1 / weights);
  }
  return q;
}

JointFeature changed(JointFeature feature, const State& change) {
  const Matrix3 turned = numerics::rotation_by(change.segment<3>(3));
  feature.axis_S = (turned * feature.axis_S).normalized();
  const Vector3 radial = turned * feature.radial_S;
  feature.radial_S = (radial - feature.axis_S.dot(radial) * feature.axis_S).normalized();
  feature.point_S += change.head<3>();
  feature.radius_m += change[6];
  return feature;
}

}  // namespace

JointFeature fuse(const JointFeature& a, const JointFeature& b) {
  ARMSIG_CHECK(a.type == b.type);
  Eigen::Matrix<double, 3, 2> across;
  across.col(0) = a.type == JointType::kRevolute ? a.radial_S : any_perpendicular(a.axis_S);
  across.col(1) = a.axis_S.cross(across.col(0));

  // Measured: the rotation that takes a's axis to b's, and how far b's point is from a's axis.
  const Vector3 tilt = a.axis_S.cross(b.axis_S);
  const Vector3 apart = b.point_S - a.point_S;
  Eigen::Vector4d innovation;
  innovation << across.transpose() * tilt, across.transpose() * apart;
  // a's axis at b's point moves by dc + rotation x apart.
  Eigen::Matrix<double, 4, 7> H = Eigen::Matrix<double, 4, 7>::Zero();
  H.block<2, 3>(0, 3) = across.transpose();
  H.block<2, 3>(2, 0) = across.transpose();
  H.block<2, 3>(2, 3) = -across.transpose() * cross_matrix(apart);
  // b's own error of the axis, at b's point.
  Eigen::Matrix<double, 4, 7> H_b = Eigen::Matrix<double, 4, 7>::Zero();
  H_b.block<2, 3>(0, 3) = across.transpose();
  H_b.block<2, 3>(2, 0) = across.transpose();
  if (a.type == JointType::kPrismatic) {  // every target has a line of its own
    innovation.tail<2>().setZero();
    H.bottomRows<2>().setZero();
    H_b.bottomRows<2>().setZero();
  }

  const Eigen::Matrix<double, 4, 7> Ha = H * a.covariance;
  const Eigen::Matrix<double, 4, 7> Hb = H_b * b.covariance;
  Eigen::Matrix4d S = Ha * H.transpose();
  S += Hb * H_b.transpose();
  if (a.type == JointType::kPrismatic) S.bottomRightCorner<2, 2>() = S.topLeftCorner<2, 2>();
  // Scaled, because the determinant of the covariance of exact data would underflow.
  const Eigen::Matrix<double, 7, 4> gain = Ha.transpose() * (S / S.trace()).inverse() / S.trace();

  JointFeature fused = changed(a, gain * innovation);
  const Eigen::Matrix<double, 7, 7> gained = gain * Ha;
  fused.covariance = a.covariance - gained;
  fused.covariance = (0.5 * (fused.covariance + fused.covariance.transpose())).eval();
  fused.quality = fuse_quality(a.quality, b.quality);
  return fused;
}

}  // namespace armsig::features
