// SPDX-License-Identifier: MIT
#include "core/measurement/point_median.hpp"

#include <algorithm>

#include <Eigen/Cholesky>

namespace armsig::measurement {
namespace {

// Squared, in 1 sigma: of a thousand honest points one is farther out.
constexpr double kFarthest = 16;

}  // namespace

Result<void> PointMedian::add(const Vector3& p_S, const Matrix3& covariance_m2) {
  if (points_.full()) return std::unexpected(Error::kCapacityExceeded);
  if (!p_S.allFinite() || !covariance_m2.allFinite()) return std::unexpected(Error::kNotFinite);
  const Eigen::LLT<Matrix3> factor(covariance_m2);
  if (factor.info() != Eigen::Success) return std::unexpected(Error::kNotPositive);
  points_.push_back({p_S, covariance_m2});
  return {};
}

double PointMedian::median_of(Eigen::Index axis) const {
  FixedVector<double, kMaxPings> values;
  for (const MedianPoint& point : points_) values.push_back(point.p_S[axis]);
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

Result<MedianPoint> PointMedian::result() const {
  MedianPoint median{Vector3(median_of(0), median_of(1), median_of(2)), Matrix3::Zero()};
  std::size_t near = 0;
  for (const MedianPoint& point : points_) {
    median.covariance_m2 += point.covariance_m2 / static_cast<double>(points_.size());
    const Vector3 off_m = point.p_S - median.p_S;
    if (off_m.dot(point.covariance_m2.llt().solve(off_m)) <= kFarthest) ++near;
  }
  if (2 * near <= points_.size()) return std::unexpected(Error::kPointsDiffer);
  return median;
}

}  // namespace armsig::measurement
