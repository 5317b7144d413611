// SPDX-License-Identifier: MIT
#include "core/features/sweep_statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <Eigen/LU>

#include "core/base/sine_cosine.hpp"

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

// Without a branch a number.
bool same_bits(const Matrix3& a, const Matrix3& b) {
  std::uint64_t difference = 0;
#pragma GCC unroll 9
  for (int i = 0; i < 9; ++i)
    difference |=
        std::bit_cast<std::uint64_t>(a.data()[i]) ^ std::bit_cast<std::uint64_t>(b.data()[i]);
  return difference == 0;
}

Vector3 motion_regressors(JointType type, double moved) {
  if (type == JointType::kPrismatic) return {1, moved, 0};
  // By half of the angle, so that 1 - cos t keeps its digits where t is small.
  const auto [s, c] = sine_and_cosine(moved / 2);
  return {1, 2 * s * c, 2 * s * s};
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

void MotionStatistics::add(const SweepPoint& point, const Vector3& x) {
  MotionRls with_point = motion;
  add_motion(point, x, with_point);
  add(point, x, with_point);
}

void MotionStatistics::add(const SweepPoint& point, const Vector3& x, const MotionRls& with_point) {
  const double variance = point.variance();
  const double weight = 1 / variance;
  if (count == 0) first_covariance_m2 = point.covariance_m2;
  if (has_one_covariance() && same_bits(point.covariance_m2, first_covariance_m2)) {
    ++same_covariance;
  } else {
    add_covariance(point, x, weight);
  }
  if (count == 0) lowest_reading = highest_reading = point.reading;
  lowest_reading = std::min(lowest_reading, point.reading);
  highest_reading = std::max(highest_reading, point.reading);
  ++count;
  variance_sum += variance;
  motion = with_point;
}

// From the first point on whose covariance is another one.
void MotionStatistics::add_covariance(const SweepPoint& point, const Vector3& x, double weight) {
  if (has_one_covariance()) {
    score_sum = score_sums();
    shape_sum = static_cast<double>(count) * shape();
  }
  const Matrix3 of_point = weight * point.covariance_m2;
  shape_sum += of_point;
  score_sum += products(x, weight * x) * upper_triangle(of_point).transpose();
}

Matrix3 MotionStatistics::shape() const {
  if (has_one_covariance()) return first_covariance_m2 * (3 / first_covariance_m2.trace());
  return shape_sum / static_cast<double>(count);
}

void SweepStatistics::add(const SweepPoint& point) {
  MotionStatistics::add(point);
  geometry.add(geometry_columns(point.p_S - origin_S), 1 / point.variance());
}

void SweepStatistics::add(const SweepPoint& point, const Vector3& x, const MotionRls& with_point) {
  MotionStatistics::add(point, x, with_point);
  geometry.add(geometry_columns(point.p_S - origin_S), 1 / point.variance());
}

Eigen::Matrix<double, 6, 6> MotionStatistics::score_sums() const {
  if (!has_one_covariance()) return score_sum;
  const Matrix3 R = motion.factor();
  return upper_triangle(R.transpose() * R) * upper_triangle(shape()).transpose();
}

Eigen::Matrix<double, 9, 9> MotionStatistics::score_covariance() const {
  constexpr Eigen::Index kPlace[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  const Eigen::Matrix<double, 6, 6> sums = score_sums();
  Eigen::Matrix<double, 9, 9> covariance;
  for (Eigen::Index row = 0; row < 9; ++row)
    for (Eigen::Index column = 0; column < 9; ++column)
      covariance(row, column) = sums(kPlace[row / 3][column / 3], kPlace[row % 3][column % 3]);
  return covariance;
}

double MotionStatistics::motion_freedom() const {
  return 3 * (static_cast<double>(count) - motion.rank());
}

double MotionStatistics::motion_chi_square() const {
  return (shape().inverse() * motion.residual_products()).trace();
}

}  // namespace armsig::features
