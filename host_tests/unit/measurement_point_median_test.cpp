// SPDX-License-Identifier: MIT
// Several points of an instrument at one standstill.
#include <limits>

#include <gtest/gtest.h>

#include "core/measurement/point_median.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::measurement {
namespace {

Matrix3 of_sigma(double sigma_m) { return sigma_m * sigma_m * Matrix3::Identity(); }

TEST(PointMedian, is_the_median_of_each_coordinate_with_the_mean_covariance) {
  PointMedian points;
  for (const double x : {0.0, 3e-5, 1e-5}) {
    ASSERT_TRUE(points.add(Vector3(1 + x, 2 - x, 3), of_sigma(1e-5 + x / 3)));
  }
  const auto median = points.result();
  ASSERT_TRUE(median);
  EXPECT_DOUBLE_EQ(median->p_S.x(), 1 + 1e-5);
  EXPECT_DOUBLE_EQ(median->p_S.y(), 2 - 1e-5);
  EXPECT_DOUBLE_EQ(median->p_S.z(), 3);
  const double mean = (1e-5 * 1e-5 + 2e-5 * 2e-5 + (4e-5 / 3) * (4e-5 / 3)) / 3;
  EXPECT_NEAR(median->covariance_m2(0, 0), mean, 1e-16);
}

TEST(PointMedian, of_an_even_number_lies_between_the_two_in_the_middle) {
  PointMedian points;
  for (const double x : {0.0, 1e-5, 3e-5, 1e-4}) {
    ASSERT_TRUE(points.add(Vector3(x, 0, 0), of_sigma(1e-4)));
  }
  EXPECT_DOUBLE_EQ(points.result()->p_S.x(), 2e-5);
}

TEST(PointMedian, is_not_moved_by_one_point_that_is_far_off) {
  PointMedian points;
  for (const double x : {0.0, 1e-5, 0.4}) {
    ASSERT_TRUE(points.add(Vector3(x, 0, 0), of_sigma(1e-5)));
  }
  ASSERT_TRUE(points.result());
  EXPECT_DOUBLE_EQ(points.result()->p_S.x(), 1e-5);
}

TEST(PointMedian, of_points_that_are_apart_by_far_more_than_their_sigma_is_refused) {
  PointMedian points;
  for (const double x : {0.0, 1e-3, 2e-3, 3e-3, 4e-3}) {
    ASSERT_TRUE(points.add(Vector3(x, 0, 0), of_sigma(1e-5)));
  }
  ASSERT_FALSE(points.result());
  EXPECT_EQ(test::failure_of(points.result()), Error::kPointsDiffer);
}

TEST(PointMedian, takes_no_point_that_is_none) {
  PointMedian points;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(test::failure_of(points.add(Vector3(nan, 0, 0), of_sigma(1))), Error::kNotFinite);
  EXPECT_EQ(test::failure_of(points.add(Vector3::Zero(), of_sigma(nan))), Error::kNotFinite);
  EXPECT_EQ(test::failure_of(points.add(Vector3::Zero(), Matrix3::Zero())), Error::kNotPositive);
  EXPECT_EQ(points.points(), 0U);
  for (std::size_t i = 0; i < kMaxPings; ++i) {
    ASSERT_TRUE(points.add(Vector3::Zero(), of_sigma(1)));
  }
  EXPECT_EQ(test::failure_of(points.add(Vector3::Zero(), of_sigma(1))), Error::kCapacityExceeded);
}

}  // namespace
}  // namespace armsig::measurement
