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

Information::Information(const Matrix3& covariance) {
  w[0] = 1 / covariance(0, 0);
  l10 = covariance(1, 0) * w[0];
  l20 = covariance(2, 0) * w[0];
  w[1] = 1 / (covariance(1, 1) - l10 * covariance(1, 0));
  const double below = covariance(2, 1) - l20 * covariance(1, 0);
  l21 = below * w[1];
  w[2] = 1 / (covariance(2, 2) - l20 * covariance(2, 0) - l21 * below);
}

double rounding_variance(const SweepPoint& point, double speed) {
  const double size = point.p_S.lpNorm<Eigen::Infinity>() + std::abs(point.reading) * speed;
  const double rounding = 16 * std::numeric_limits<double>::epsilon() * size;
  return rounding * rounding;
}

Trial MotionStatistics::tried(const SweepPoint& point) const {
  const Vector3 x = regressors(point);
  return {
      x, motion.rotations(x, point.p_S - origin_S, 1 / point.variance()),
      count == 0 || (has_one_covariance() && same_bits(point.covariance_m2, first_covariance_m2))};
}

void MotionStatistics::add(const SweepPoint& point, const Trial& trial) {
  if (count == 0) {
    first_covariance_m2 = point.covariance_m2;
    first_information = Information(point.covariance_m2);
    lowest_reading = highest_reading = point.reading;
  }
  if (trial.has_first_covariance) {
    ++same_covariance;
  } else {
    add_covariance(point, trial.regressors);
  }
  lowest_reading = std::min(lowest_reading, point.reading);
  highest_reading = std::max(highest_reading, point.reading);
  ++count;
  variance_sum += point.variance();
  motion.update(trial.rotations);
}

// From the first point on whose covariance is another one.
void MotionStatistics::add_covariance(const SweepPoint& point, const Vector3& x) {
  if (has_one_covariance()) {
    score_sum = score_sums();
    shape_sum = static_cast<double>(count) * shape();
  }
  const double weight = 1 / point.variance();
  const Matrix3 of_point = weight * point.covariance_m2;
  shape_sum += of_point;
  score_sum += products(x, weight * x) * upper_triangle(of_point).transpose();
}

Matrix3 MotionStatistics::shape() const {
  if (has_one_covariance()) return first_covariance_m2 * (3 / first_covariance_m2.trace());
  return shape_sum / static_cast<double>(count);
}

void SweepStatistics::add(const SweepPoint& point) {
  if (count == 0) {
    origin_reading = point.reading;
    origin_S = point.p_S;
  }
  add(point, tried(point));
}

void SweepStatistics::add(const SweepPoint& point, const Trial& trial) {
  MotionStatistics::add(point, trial);
  const Vector3 p = point.p_S - origin_S;
  if (method == Method::kPaper) {
    Geometry::RightHandSides monomials;
    monomials << p.squaredNorm(), products(p, p).head<5>();
    of_points.update({1, p.x(), p.y(), p.z()}, monomials, 1 / point.variance());
  } else if (type == JointType::kRevolute) {
    squares.update(p.squaredNorm(), trial.rotations);
  }
}

// The rows of the motion's factor without its regressors but the first, which is 1, and rows that
// have the products of its residuals (by elimination; what is left of exact data is rounding).
Geometry SweepStatistics::geometry() const {
  if (method == Method::kPaper) return of_points;
  Geometry geometry;
  Geometry::RightHandSides square = Geometry::RightHandSides::Zero();
  for (int i = 0; i < 3; ++i) {
    const MotionRls::Row& kept = motion.rows()[i];
    square[0] = squares.rotated[i];
    geometry.update({i == 0 ? 1.0 : 0.0, kept[3], kept[4], kept[5]}, square, kept[i]);
  }
  Eigen::Matrix4d left;
  left << motion.residual_products(), squares.products, squares.products.transpose(),
      squares.square;
  for (int i = 0; i < 4; ++i) {
    const double pivot = left(i, i);
    if (!(pivot > 0)) continue;
    const Eigen::Vector4d row = left.col(i) / pivot;
    left -= pivot * row * row.transpose();
    square[0] = row[3];
    geometry.update({0, row[0], row[1], row[2]}, square, pivot);
  }
  return geometry;
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
