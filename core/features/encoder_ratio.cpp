// SPDX-License-Identifier: MIT
#include "core/features/encoder_ratio.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::features {

EncoderRatio encoder_ratio(const SweepStatistics& statistics) {
  const MotionRls::Coefficients phi = statistics.motion.solve();
  const Matrix3 R = statistics.motion.factor();
  const Matrix3 shape = statistics.shape();
  const Vector3 B = phi.row(1);
  const Vector3 b = B.normalized();
  // The coefficients have the covariance (R^T R)^-1 (x) shape. The inverse of a triangular factor
  // is triangular: that of its lower right corner belongs to the last coefficients alone.
  if (statistics.type == JointType::kPrismatic)
    return {B.norm(), std::sqrt(b.dot(shape * b)) / std::abs(R(1, 1))};

  const Vector3 A = -phi.row(2);
  const Vector3 a = A.normalized();
  Eigen::Matrix2d root;
  root << 1 / R(1, 1), -R(1, 2) / (R(1, 1) * R(2, 2)), 0, 1 / R(2, 2);
  const Eigen::Matrix2d P = root * root.transpose();
  // d ln(|A| / |B|) = a.dA / |A| - b.dB / |B|, with A the third coefficient negated.
  const double aa = a.dot(shape * a) * P(1, 1) / A.squaredNorm();
  const double bb = b.dot(shape * b) * P(0, 0) / B.squaredNorm();
  const double ab = -a.dot(shape * b) * P(0, 1) / (A.norm() * B.norm());
  const double ratio = A.norm() / B.norm();
  return {ratio, ratio * std::sqrt(std::max(aa + bb - 2 * ab, 0.0))};
}

}  // namespace armsig::features
