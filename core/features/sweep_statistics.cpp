// SPDX-License-Identifier: MIT
#include "core/features/sweep_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

namespace armsig::features {

Vector3 motion_regressors(JointType type, double moved) {
  if (type == JointType::kPrismatic) return {1, moved, 0};
  const double half = std::sin(moved / 2);
  return {1, std::sin(moved), 2 * half * half};
}

GeometryFactor::Row geometry_columns(const Vector3& p) {
  GeometryFactor::Row row;
  row << 1, p, p.x() * p.x(), p.x() * p.y(), p.x() * p.z(), p.y() * p.y(), p.y() * p.z(),
      p.z() * p.z();
  return row;
}

double rounding_variance(const SweepPoint& point, double speed) {
  const double size = point.p_S.lpNorm<Eigen::Infinity>() + std::abs(point.reading) * speed;
  const double rounding = 16 * std::numeric_limits<double>::epsilon() * size;
  return rounding * rounding;
}

void SweepStatistics::add(const SweepPoint& point) {
  lowest_reading = count == 0 ? point.reading : std::min(lowest_reading, point.reading);
  highest_reading = count == 0 ? point.reading : std::max(highest_reading, point.reading);
  ++count;

  const double variance = point.variance();
  const double weight = 1 / std::sqrt(variance);
  const Vector3 x = weight * regressors(point);
  const Vector3 p = point.p_S - origin_S;
  motion.update(x, weight * p);
  geometry.add(weight * geometry_columns(p));

  const Matrix3 shape = point.covariance_m2 / variance;
  variance_sum += variance;
  shape_sum += shape;
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = 0; j < 3; ++j)
      score_sum.block<3, 3>(3 * i, 3 * j) += (x[i] * x[j]) * shape;
}

double SweepStatistics::motion_freedom() const {
  return 3 * (static_cast<double>(count) - motion.rank());
}

double SweepStatistics::motion_chi_square() const {
  return (shape().inverse() * motion.residual_products()).trace();
}

}  // namespace armsig::features
