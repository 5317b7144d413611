// SPDX-License-Identifier: MIT
// What is kept of a sweep.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/features/sweep_statistics.hpp"
#include "host_tests/support/simulated_sweep.hpp"

namespace armsig::features {
namespace {

// Some with another covariance than the first, from `differs_from` on.
std::vector<SweepPoint> points_of(std::size_t count, std::size_t differs_from, double reading_0) {
  test::Random random(3);
  std::vector<SweepPoint> points;
  for (std::size_t k = 0; k < count; ++k) {
    SweepPoint point;
    point.reading = reading_0 + 0.05 * static_cast<double>(k);
    point.p_S = Vector3(0.3, -0.2, 2) + 0.4 * random.normal_vector();
    point.covariance_m2 = test::isotropic(2e-4);
    if (k >= differs_from) point.covariance_m2(0, 0) *= 1 + 0.1 * static_cast<double>(k);
    points.push_back(point);
  }
  return points;
}

MotionStatistics one_by_one(JointType type, const std::vector<SweepPoint>& points) {
  MotionStatistics statistics(type, points[0]);
  for (const SweepPoint& point : points) statistics.add(point);
  return statistics;
}

// The sum that the comment of score_covariance() states, term by term.
TEST(MotionStatistics, covariance_of_the_score_is_the_sum_over_the_points) {
  for (const std::size_t differs_from : {30U, 12U, 1U}) {
    const std::vector<SweepPoint> points = points_of(30, differs_from, -0.4);
    Eigen::Matrix<double, 9, 9> sum = Eigen::Matrix<double, 9, 9>::Zero();
    for (const SweepPoint& point : points) {
      const double t = point.reading - points[0].reading;
      const Vector3 x(1, std::sin(t), 1 - std::cos(t));
      const double variance = point.covariance_m2.trace() / 3;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          sum.block<3, 3>(3 * i, 3 * j) +=
              x[i] * x[j] / (variance * variance) * point.covariance_m2;
        }
      }
    }
    const MotionStatistics statistics = one_by_one(JointType::kRevolute, points);
    EXPECT_TRUE(statistics.score_covariance().isApprox(sum, 1e-11)) << differs_from;
  }
}

// 16 units in the last place of what is as large as 1 + 3: 2^4 * 2^-52 * 2^2 = 2^-46.
TEST(RoundingVariance, is_that_of_the_largest_coordinate_and_of_what_the_reading_moves) {
  const SweepPoint point{-6, Vector3(0.5, -1, 0.25), Matrix3::Identity()};
  EXPECT_EQ(rounding_variance(point, 0.5), std::ldexp(1.0, -92));
  EXPECT_EQ(rounding_variance({0, Vector3(0, 0, 1), Matrix3::Identity()}, 0.5),
            std::ldexp(1.0, -96));
}

}  // namespace
}  // namespace armsig::features
