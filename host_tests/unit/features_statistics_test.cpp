// SPDX-License-Identifier: MIT
// What is kept of a sweep: the same however its points come in.
#include <cmath>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "core/features/sweep_statistics.hpp"
#include "host_tests/support/simulated_sweep.hpp"

namespace armsig::features {
namespace {

// Some with another covariance than the first, from `differs_from` on.
std::vector<SweepPoint> points_of(std::size_t count, std::size_t differs_from, double reading_0) {
  testing::Random random(3);
  std::vector<SweepPoint> points;
  for (std::size_t k = 0; k < count; ++k) {
    SweepPoint point;
    point.reading = reading_0 + 0.05 * static_cast<double>(k);
    point.p_S = Vector3(0.3, -0.2, 2) + 0.4 * random.normal_vector();
    point.covariance_m2 = testing::isotropic(2e-4);
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

void expect_same(const MotionStatistics& a, const MotionStatistics& b) {
  EXPECT_EQ(a.count, b.count);
  EXPECT_EQ(a.lowest_reading, b.lowest_reading);
  EXPECT_EQ(a.highest_reading, b.highest_reading);
  EXPECT_EQ(a.has_one_covariance(), b.has_one_covariance());
  EXPECT_TRUE(a.motion.factor().isApprox(b.motion.factor(), 1e-12));
  EXPECT_TRUE(
      a.motion.rotated_right_hand_sides().isApprox(b.motion.rotated_right_hand_sides(), 1e-12));
  EXPECT_TRUE(a.motion.residual_products().isApprox(b.motion.residual_products(), 1e-12));
  EXPECT_NEAR(a.mean_variance() / b.mean_variance(), 1, 1e-12);
  EXPECT_TRUE(a.shape().isApprox(b.shape(), 1e-12));
  EXPECT_TRUE(a.score_covariance().isApprox(b.score_covariance(), 1e-12));
}

TEST(MotionStatistics, of_many_points_at_once_are_those_of_each) {
  for (const JointType type : {JointType::kRevolute, JointType::kPrismatic}) {
    for (const std::size_t count : {1U, 15U, 16U, 17U, 40U, 64U, 67U, 200U}) {
      const std::vector<SweepPoint> points = points_of(count, count, 0.7);
      MotionStatistics together(type, points[0]);
      together.add(points);
      expect_same(together, one_by_one(type, points));
    }
  }
}

TEST(MotionStatistics, of_many_points_at_once_may_change_their_covariance) {
  for (const std::size_t differs_from : {21U, 39U, 100U}) {
    const std::vector<SweepPoint> points = points_of(differs_from + 30, differs_from, 0.7);
    MotionStatistics together(JointType::kRevolute, points[0]);
    together.add(points);
    EXPECT_FALSE(together.has_one_covariance());
    expect_same(together, one_by_one(JointType::kRevolute, points));
  }
}

TEST(MotionStatistics, of_many_points_at_once_take_a_million_turns) {
  std::vector<SweepPoint> points = points_of(20, 20, 0.7);
  points[5].reading += 7e6;
  MotionStatistics together(JointType::kRevolute, points[0]);
  together.add(points);
  expect_same(together, one_by_one(JointType::kRevolute, points));
}

TEST(MotionStatistics, of_many_points_at_once_come_on_top_of_earlier_ones) {
  const std::vector<SweepPoint> points = points_of(43, 43, 0.7);
  MotionStatistics together(JointType::kRevolute, points[0]);
  const std::span<const SweepPoint> all(points);
  together.add(all.first(20));
  together.add(all.subspan(20));
  expect_same(together, one_by_one(JointType::kRevolute, points));
}

// First, middle and last at one reading, as after a sweep there and back and there again.
TEST(MotionStatistics, of_many_points_at_once_may_show_three_at_one_reading) {
  std::vector<SweepPoint> points = points_of(40, 40, 0.7);
  points[20].reading = points[39].reading = points[0].reading;
  MotionStatistics together(JointType::kRevolute, points[0]);
  together.add(points);
  expect_same(together, one_by_one(JointType::kRevolute, points));
}

// A sensor 4 m away, points exact to rounding: nothing but that is left over.
TEST(MotionStatistics, of_many_points_at_once_leave_nothing_of_an_exact_circle) {
  for (const double arc : {0.1, 1.5, 6.0}) {
    std::vector<SweepPoint> points;
    for (int k = 0; k < 360; ++k) {
      const double t = arc * std::fmod(0.618 * k, 1.0);  // in no order
      points.push_back(
          {0.3 + t, Vector3(4 + 0.5 * std::cos(t), 0.5 * std::sin(t), 1), Matrix3::Identity()});
    }
    MotionStatistics together(JointType::kRevolute, points[0]);
    together.add(points);
    EXPECT_LT(std::sqrt(together.motion.residual_products().trace() / 360), 2e-15) << arc;
    EXPECT_EQ(together.motion.rank(), 3);
  }
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

}  // namespace
}  // namespace armsig::features
