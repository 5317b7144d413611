// SPDX-License-Identifier: MIT
#include "core/features/sweep_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

namespace armsig::features {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

// The products a_i b_j of the upper triangle, row by row: 00 01 02 11 12 22.
Vector6 products(const Vector3& a, const Vector3& b) {
  return {a[0] * b[0], a[0] * b[1], a[0] * b[2], a[1] * b[1], a[1] * b[2], a[2] * b[2]};
}

Vector6 upper_triangle(const Matrix3& a) {
  return {a(0, 0), a(0, 1), a(0, 2), a(1, 1), a(1, 2), a(2, 2)};
}

}  // namespace

Vector3 motion_regressors(JointType type, double moved) {
  if (type == JointType::kPrismatic) return {1, moved, 0};
  const double half = std::sin(moved / 2);
  return {1, std::sin(moved), 2 * half * half};
}

GeometryFactor::Row geometry_columns(const Vector3& p) {
  GeometryFactor::Row row;
  row[0] = 1;
  row.segment<3>(1) = p;
  row.tail<6>() = products(p, p);
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
  const double weight = 1 / variance;
  const Vector3 x = regressors(point);
  const Vector3 p = point.p_S - origin_S;
  motion.update(x, p, weight);
  geometry.add(geometry_columns(p), weight);

  const Matrix3 shape = weight * point.covariance_m2;
  variance_sum += variance;
  shape_sum += shape;
  const Vector6 shapes = upper_triangle(shape);
  const Vector6 pairs = products(x, weight * x);
  for (Eigen::Index column = 0; column < 6; ++column)
    score_sum.col(column) += shapes[column] * pairs;
}

Eigen::Matrix<double, 9, 9> SweepStatistics::score_covariance() const {
  constexpr Eigen::Index kPlace[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  Eigen::Matrix<double, 9, 9> covariance;
  for (Eigen::Index row = 0; row < 9; ++row)
    for (Eigen::Index column = 0; column < 9; ++column)
      covariance(row, column) = score_sum(kPlace[row / 3][column / 3], kPlace[row % 3][column % 3]);
  return covariance;
}

double SweepStatistics::motion_freedom() const {
  return 3 * (static_cast<double>(count) - motion.rank());
}

double SweepStatistics::motion_chi_square() const {
  return (shape().inverse() * motion.residual_products()).trace();
}

}  // namespace armsig::features
