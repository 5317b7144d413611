// SPDX-License-Identifier: MIT
// Outliers, order of the rows, length of the sweep: none of them may matter.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/features/sweep_estimator.hpp"
#include "host_tests/support/allocation_guard.hpp"
#include "host_tests/support/simulated_sweep.hpp"

namespace armsig::features {
namespace {

using test::TrueMotion;

struct Point {
  double reading = 0;
  Vector3 good_S;
  Vector3 bad_S;
  bool is_outlier = false;
};

// A fifth of the points off by what an echo too long by 20 to 300 mm on one receiver makes of a
// position: centimetres to decimetres, in any direction.
std::vector<Point> contaminated(const TrueMotion& motion, double range, std::size_t count,
                                test::Random& random) {
  std::vector<Point> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double reading = test::even_reading(motion, range, i, count);
    points[i] = {reading, motion.at(reading) + test::kSweepSigma_m * random.normal_vector(),
                 Vector3::Zero(), i < count / 5};
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t other =
        i + static_cast<std::size_t>(random.uniform(0, static_cast<double>(count - i) - 1e-9));
    std::swap(points[i].is_outlier, points[other].is_outlier);
  }
  for (Point& point : points) {
    point.bad_S = point.good_S;
    if (point.is_outlier) point.bad_S += random.uniform(0.02, 0.3) * random.direction();
  }
  return points;
}

void expect_outliers_harmless(std::size_t count, double arc, double stated_m, bool shuffled,
                              int trials, unsigned seed) {
  test::Random random(seed);
  double with = 0;
  double without = 0;
  int moved = 0;
  for (int k = 0; k < trials; ++k) {
    const TrueMotion motion = test::random_motion(JointType::kRevolute, random);
    std::vector<Point> points = contaminated(motion, arc, count, random);
    if (shuffled) std::shuffle(points.begin(), points.end(), random.engine());
    SweepEstimator clean({JointType::kRevolute, {}});
    SweepEstimator dirty({JointType::kRevolute, {}});
    for (const Point& point : points) {
      ASSERT_TRUE(clean.add(point.reading, point.good_S, test::isotropic(stated_m)));
      ASSERT_TRUE(dirty.add(point.reading, point.bad_S, test::isotropic(stated_m)));
    }
    const auto a = clean.estimate();
    const auto b = dirty.estimate();
    ASSERT_TRUE(a && b);
    // Every outlier is counted, and of the good points no more than the gate's 1 in 10,000.
    EXPECT_GE(b->quality.rejected, count / 5);
    EXPECT_LE(b->quality.rejected, count / 5 + 2 + count / 1000);
    EXPECT_EQ(b->quality.used + b->quality.rejected, count);

    const Vector3 n = motion.R_SC.col(2);
    with += b->axis_S.cross(n).squaredNorm();
    without += a->axis_S.cross(n).squaredNorm();
    const double sigma = std::sqrt(b->covariance.block<3, 3>(3, 3).trace());
    if ((b->axis_S - a->axis_S).norm() > 2 * sigma) ++moved;
    EXPECT_LT((b->axis_S - a->axis_S).norm(), 3 * sigma);
  }
  // Losing a fifth of the points costs 12 % by itself.
  EXPECT_LT(std::sqrt(with / without), 1.5) << count << " points";
  EXPECT_LE(moved, trials / 50) << count << " points";
}

TEST(Outliers, of_a_fifth_of_a_short_sweep_are_counted_and_harmless) {
  for (const std::size_t count : {std::size_t{10}, std::size_t{36}, std::size_t{120}}) {
    expect_outliers_harmless(count, radians(60), test::kSweepSigma_m, false, 200, 61);
    expect_outliers_harmless(count, radians(120), 0, false, 200, 62);
  }
}

TEST(Outliers, of_a_fifth_of_a_long_sweep_are_counted_and_harmless) {
  for (const bool shuffled : {false, true}) {
    expect_outliers_harmless(1000, radians(90), test::kSweepSigma_m, shuffled, 40, 63);
    expect_outliers_harmless(1000, radians(90), 0, shuffled, 40, 64);
  }
}

TEST(Outliers, of_exact_data_are_found_too) {
  test::Random random(65);
  for (int k = 0; k < 50; ++k) {
    const TrueMotion motion = test::random_motion(JointType::kRevolute, random);
    SweepEstimator estimator({JointType::kRevolute, {}});
    for (std::size_t i = 0; i < 40; ++i) {
      const double reading = test::even_reading(motion, 1, i, 40);
      const Vector3 off = i % 5 == 2 ? Vector3(0.02 * random.direction()) : Vector3::Zero();
      ASSERT_TRUE(estimator.add(reading, motion.at(reading) + off, Matrix3::Zero()));
    }
    const auto feature = estimator.estimate();
    ASSERT_TRUE(feature);
    EXPECT_EQ(feature->quality.rejected, 8U);
    EXPECT_LT(test::feature_error(*feature, motion).norm(), 1e-12);
  }
}

TEST(Outliers, of_a_prismatic_sweep_are_counted_and_harmless) {
  test::Random random(66);
  for (int k = 0; k < 100; ++k) {
    const TrueMotion motion = test::random_motion(JointType::kPrismatic, random);
    SweepEstimator estimator({JointType::kPrismatic, {}});
    for (const Point& point : contaminated(motion, 0.5, 25, random))
      ASSERT_TRUE(estimator.add(point.reading, point.bad_S, test::isotropic(test::kSweepSigma_m)));
    const auto feature = estimator.estimate();
    ASSERT_TRUE(feature);
    EXPECT_EQ(feature->quality.rejected, 5U);
    EXPECT_LT(feature->axis_S.cross(motion.R_SC.col(2)).norm(), 5e-3);
  }
}

TEST(OrderOfRows, does_not_matter) {
  test::Random random(71);
  for (int k = 0; k < 50; ++k) {
    const TrueMotion motion = test::random_motion(JointType::kRevolute, random);
    std::vector<Point> points = contaminated(motion, 2, 100, random);
    std::vector<Vector3> targets;
    std::vector<std::size_t> rejected;
    for (int order = 0; order < 3; ++order) {
      SweepEstimator estimator({JointType::kRevolute, {}});
      for (const Point& point : points)
        ASSERT_TRUE(
            estimator.add(point.reading, point.bad_S, test::isotropic(test::kSweepSigma_m)));
      const auto feature = estimator.estimate();
      ASSERT_TRUE(feature);
      targets.push_back(feature->target_at(1));
      rejected.push_back(feature->quality.rejected);
      std::shuffle(points.begin(), points.end(), random.engine());
    }
    for (int order = 1; order < 3; ++order) {
      EXPECT_EQ(rejected[static_cast<std::size_t>(order)], rejected[0]);
      EXPECT_LT((targets[static_cast<std::size_t>(order)] - targets[0]).norm(), 1e-12);
    }
  }
}

TEST(MillionPoints, take_no_memory_and_lose_no_digits) {
  test::Random random(81);
  const TrueMotion motion = test::random_motion(JointType::kRevolute, random);
  constexpr std::size_t kCount = 1'000'000;
  std::size_t refused = 0;
  const test::AllocationGuard guard;
  SweepEstimator estimator({JointType::kRevolute, {}});
  SweepEstimator paper({JointType::kRevolute, {}, Method::kPaper});
  for (std::size_t i = 0; i < kCount; ++i) {
    const double reading = test::even_reading(motion, 3, i, kCount);
    Vector3 p_S = motion.at(reading) + test::kSweepSigma_m * random.normal_vector();
    if (i % 5 == 3) p_S += random.uniform(0.02, 0.3) * random.direction();
    for (SweepEstimator* of_method : {&estimator, &paper})
      if (!of_method->add(reading, p_S, test::isotropic(test::kSweepSigma_m))) ++refused;
  }
  const auto feature = estimator.estimate();
  const auto by_paper = paper.estimate();
  const std::size_t allocations = guard.count();

  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(refused, 0U);
  ASSERT_TRUE(feature && by_paper);
  EXPECT_EQ(feature->quality.used + feature->quality.rejected, kCount);
  EXPECT_GE(feature->quality.rejected, kCount / 5);
  EXPECT_LE(feature->quality.rejected, kCount / 5 + 200);
  const Eigen::Matrix<double, 7, 1> e = test::feature_error(*feature, motion);
  EXPECT_LT(e.dot(feature->covariance.ldlt().solve(e)), 30);  // 7 degrees of freedom
  EXPECT_LT(e.norm(), 5e-6);
}

TEST(AllocationGuard, sees_an_allocation) {
  const test::AllocationGuard guard;
  // The function, which no compiler leaves out as it may a vector that nobody reads.
  void* const block = ::operator new(1000);
  const std::size_t allocations = guard.count();
  ::operator delete(block);
  EXPECT_EQ(allocations, 1U);
}

}  // namespace
}  // namespace armsig::features
