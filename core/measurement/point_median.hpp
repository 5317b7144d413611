// SPDX-License-Identifier: MIT
// Several points that an instrument measured at one standstill of the arm: the median.
#pragma once

#include <cstddef>

#include "core/base/error.hpp"
#include "core/base/fixed_vector.hpp"
#include "core/base/pose.hpp"
#include "core/measurement/ping_median.hpp"

namespace armsig::measurement {

struct MedianPoint {
  Vector3 p_S = Vector3::Zero();
  // The mean of the points'. A tracker's error is mostly the same in all points of one pose, so
  // their number does not lower it.
  Matrix3 covariance_m2 = Matrix3::Zero();
};

class PointMedian {
 public:
  // Errors: kCapacityExceeded after kMaxPings; kNotFinite; kNotPositive (the covariance is not
  // positive definite). Nothing is stored then.
  [[nodiscard]] Result<void> add(const Vector3& p_S, const Matrix3& covariance_m2);
  [[nodiscard]] std::size_t points() const { return points_.size(); }

  // The median of each coordinate. Error: kPointsDiffer (half of the points or fewer are as near to
  // it as their covariance says). Precondition: points() > 0.
  [[nodiscard]] Result<MedianPoint> result() const;

 private:
  [[nodiscard]] double median_of(Eigen::Index axis) const;

  FixedVector<MedianPoint, kMaxPings> points_;
};

}  // namespace armsig::measurement
