// SPDX-License-Identifier: MIT
// The estimator of a sweep: what it makes of good points, and of bad ones among them.
#include <cmath>

#include <gtest/gtest.h>

#include "core/features/sweep_estimator.hpp"
#include "host_tests/support/measured_sweep.hpp"

namespace armsig::features {
namespace {

using test::by;
using test::kBothMethods;
using test::kPrismaticSweep;
using test::kRevoluteSweep;
using test::measured;
using test::some_motion;
using test::Sweep;
using test::TrueMotion;

TEST(SweepEstimator, recovers_an_exact_circle_by_both_methods) {
  const TrueMotion motion = some_motion(JointType::kRevolute);
  for (const Method method : kBothMethods) {
    const auto feature = measured(by(method, kRevoluteSweep), {motion, 1.5, 20}).estimate();
    ASSERT_TRUE(feature);
    EXPECT_LT(test::feature_error(*feature, motion).norm(), 1e-13);
    EXPECT_EQ(feature->quality.used, 20U);
    EXPECT_EQ(feature->quality.rejected, 0U);
    EXPECT_NEAR(feature->quality.arc(), 1.5, 1e-15);
    EXPECT_LT(feature->quality.rms_normal_m, 1e-14);
    EXPECT_LT(feature->quality.rms_radial_m, 1e-14);
    EXPECT_LT(feature->quality.rms_tangential_m, 1e-14);
  }
}

TEST(SweepEstimator, recovers_an_exact_line_by_both_methods) {
  const TrueMotion motion = some_motion(JointType::kPrismatic, 0);
  for (const Method method : kBothMethods) {
    const auto feature = measured(by(method, kPrismaticSweep), {motion, 0.4, 9}).estimate();
    ASSERT_TRUE(feature);
    EXPECT_LT(test::feature_error(*feature, motion).norm(), 1e-13);
    EXPECT_NEAR(feature->axis_S.dot(feature->radial_S), 0, 1e-15);
    EXPECT_EQ(feature->radius_m, 0);
  }
}

TEST(SweepEstimator, axis_follows_the_sense_of_the_reading) {
  const TrueMotion motion = some_motion(JointType::kRevolute);
  for (const Method method : kBothMethods) {
    const auto feature = measured(by(method, kRevoluteSweep), {motion, -1.5, 20}).estimate();
    ASSERT_TRUE(feature);
    EXPECT_LT((feature->axis_S - motion.R_SC.col(2)).norm(), 1e-13);
  }
}

TEST(SweepEstimator, accepts_an_exact_arc_of_ten_degrees) {
  for (const Method method : kBothMethods)
    EXPECT_TRUE(
        measured(by(method, kRevoluteSweep), {some_motion(JointType::kRevolute), radians(10), 20})
            .estimate());
}

// Readings that an encoder or a file has rounded to a picoradian.
TEST(SweepEstimator, accepts_the_least_arc_with_readings_as_they_come_rounded) {
  for (const Method method : kBothMethods)
    EXPECT_TRUE(measured(by(method, kRevoluteSweep),
                         {some_motion(JointType::kRevolute), radians(5) - 1e-12, 20})
                    .estimate());
}

TEST(SweepEstimator, readings_of_ten_thousand_turns_cost_no_digits) {
  TrueMotion motion = some_motion(JointType::kRevolute);
  motion.first_reading = 2 * kPi * 1e4;
  for (const Method method : kBothMethods) {
    const auto feature = measured(by(method, kRevoluteSweep), {motion, 1.5, 20}).estimate();
    ASSERT_TRUE(feature);
    EXPECT_LT(test::feature_error(*feature, motion).norm(), 1e-13);
  }
}

TEST(SweepEstimator, repeated_readings_are_welcome) {
  const TrueMotion motion = some_motion(JointType::kRevolute);
  SweepEstimator estimator(kRevoluteSweep);
  for (int i = 0; i < 12; ++i) {
    const double reading = motion.first_reading + 0.5 * (i % 3);
    ASSERT_TRUE(estimator.add(reading, motion.at(reading), Matrix3::Zero()));
  }
  EXPECT_TRUE(estimator.estimate());
}

TEST(SweepEstimator, estimates_sigma_where_none_is_stated) {
  const auto feature =
      measured(kRevoluteSweep, {some_motion(JointType::kRevolute), 2, 100, test::kSweepSigma_m, 0})
          .estimate();
  ASSERT_TRUE(feature);
  EXPECT_TRUE(feature->quality.sigma_is_estimated);
  EXPECT_NEAR(feature->quality.sigma_m, test::kSweepSigma_m, 0.15 * test::kSweepSigma_m);
}

TEST(SweepEstimator, keeps_a_stated_sigma_that_the_residuals_do_not_contradict) {
  const auto feature = measured(kRevoluteSweep, {some_motion(JointType::kRevolute), 2, 100,
                                                 test::kSweepSigma_m, test::kSweepSigma_m})
                           .estimate();
  ASSERT_TRUE(feature);
  EXPECT_FALSE(feature->quality.sigma_is_estimated);
  EXPECT_NEAR(feature->quality.sigma_m, test::kSweepSigma_m, 1e-15);
}

TEST(SweepEstimator, replaces_a_sigma_stated_three_times_too_small) {
  const auto feature = measured(kRevoluteSweep, {some_motion(JointType::kRevolute), 2, 100,
                                                 3 * test::kSweepSigma_m, test::kSweepSigma_m})
                           .estimate();
  ASSERT_TRUE(feature);
  EXPECT_TRUE(feature->quality.sigma_is_estimated);
  EXPECT_NEAR(feature->quality.sigma_m, 3 * test::kSweepSigma_m, 0.45 * test::kSweepSigma_m);
  EXPECT_EQ(feature->quality.rejected, 0U);
}

TEST(SweepEstimator, a_row_without_covariance_takes_that_of_the_row_before) {
  const TrueMotion motion = some_motion(JointType::kRevolute);
  SweepEstimator stated(kRevoluteSweep);
  SweepEstimator partly(kRevoluteSweep);
  for (std::size_t i = 0; i < 20; ++i) {
    const double reading = test::even_reading(motion, 2, i, 20);
    ASSERT_TRUE(stated.add(reading, motion.at(reading), test::isotropic(test::kSweepSigma_m)));
    ASSERT_TRUE(partly.add(reading, motion.at(reading),
                           test::isotropic(i % 2 == 0 ? test::kSweepSigma_m : 0)));
  }
  const auto a = stated.estimate();
  const auto b = partly.estimate();
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->covariance, b->covariance);
}

TEST(SweepEstimator, target_is_predicted_at_any_reading) {
  const TrueMotion motion = some_motion(JointType::kRevolute);
  const auto feature = measured(kRevoluteSweep, {motion, 1.5, 20}).estimate();
  ASSERT_TRUE(feature);
  EXPECT_LT((feature->target_at(7) - motion.at(7)).norm(), 1e-13);
}

TEST(SweepEstimator, an_outlier_first_is_neither_reference_nor_used) {
  const TrueMotion motion = some_motion(JointType::kRevolute);
  SweepEstimator estimator(kRevoluteSweep);
  for (std::size_t i = 0; i < 20; ++i) {
    const double reading = test::even_reading(motion, 1.5, i, 20);
    const Vector3 p_S = motion.at(reading) + (i == 0 ? Vector3(1e3, 0, 0) : Vector3::Zero());
    ASSERT_TRUE(estimator.add(reading, p_S, Matrix3::Zero()));
  }
  const auto feature = estimator.estimate();
  ASSERT_TRUE(feature);
  EXPECT_EQ(feature->quality.rejected, 1U);
  EXPECT_EQ(feature->reference_reading, test::even_reading(motion, 1.5, 1, 20));
  EXPECT_LT(test::feature_error(*feature, motion).norm(), 1e-12);
}

// Points that agree are taken in as they come; one outlier among them, and all are searched: to the
// same feature, whether they are still held or not.
TEST(SweepEstimator, points_taken_in_as_they_come_are_those_of_the_search) {
  const TrueMotion motion = some_motion(JointType::kRevolute);
  for (const std::size_t points : {36U, 100U, 200U}) {
    test::Random random(7);
    SweepEstimator as_they_come(kRevoluteSweep);
    SweepEstimator searched(kRevoluteSweep);
    for (std::size_t i = 0; i < points; ++i) {
      const double reading = test::even_reading(motion, 1.5, i, points);
      const Vector3 p_S = motion.at(reading) + 0.8 * test::kSweepSigma_m * random.normal_vector();
      ASSERT_TRUE(as_they_come.add(reading, p_S, test::isotropic(test::kSweepSigma_m)));
      ASSERT_TRUE(searched.add(reading, p_S, test::isotropic(test::kSweepSigma_m)));
      if (i != 20) continue;
      ASSERT_TRUE(
          searched.add(reading, p_S + Vector3(0.1, 0, 0), test::isotropic(test::kSweepSigma_m)));
    }
    EXPECT_EQ(as_they_come.state().waiting_is_accepted, points < kGateCapacity) << points;
    EXPECT_FALSE(searched.state().waiting_is_accepted);
    const auto one = as_they_come.estimate();
    const auto other = searched.estimate();
    ASSERT_TRUE(one && other);
    EXPECT_EQ(one->quality.rejected, 0U);
    EXPECT_EQ(other->quality.rejected, 1U);
    EXPECT_EQ(one->quality.used, points);
    EXPECT_LT((one->point_S - other->point_S).norm(), 1e-12);
    EXPECT_LT((one->axis_S - other->axis_S).norm(), 1e-12);
    EXPECT_NEAR(one->quality.rms_normal_m, other->quality.rms_normal_m, 1e-12);
    EXPECT_NEAR(one->quality.rms_radial_m, other->quality.rms_radial_m, 1e-12);
    EXPECT_TRUE(one->covariance.isApprox(other->covariance, 1e-9));
  }
}

// An outlier among the first eight hides from those that are fitted with it.
TEST(SweepEstimator, an_outlier_among_the_first_is_found) {
  const TrueMotion motion = some_motion(JointType::kRevolute);
  for (const std::size_t place : {0U, 3U, 7U}) {
    test::Random random(8);
    SweepEstimator estimator(kRevoluteSweep);
    for (std::size_t i = 0; i < 36; ++i) {
      const double reading = test::even_reading(motion, 1.5, i, 36);
      Vector3 p_S = motion.at(reading) + test::kSweepSigma_m * random.normal_vector();
      if (i == place) p_S += 9 * test::kSweepSigma_m * random.direction();
      ASSERT_TRUE(estimator.add(reading, p_S, test::isotropic(test::kSweepSigma_m)));
    }
    const auto feature = estimator.estimate();
    ASSERT_TRUE(feature);
    EXPECT_EQ(feature->quality.rejected, 1U) << place;
  }
}

TEST(SweepEstimator, may_be_asked_again_and_again) {
  const TrueMotion motion = some_motion(JointType::kRevolute);
  SweepEstimator estimator =
      measured(kRevoluteSweep, {motion, 1.5, 20, test::kSweepSigma_m, test::kSweepSigma_m});
  const auto first = estimator.estimate();
  const auto second = estimator.estimate();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->axis_S, second->axis_S);
  EXPECT_EQ(estimator.count(), 20U);
}

// Three hundred pings at each reading: the points before do not predict those at the next reading.
TEST(SweepEstimator, judges_points_after_a_jump_together) {
  const TrueMotion motion = some_motion(JointType::kRevolute);
  test::Random random(6);
  SweepEstimator estimator(kRevoluteSweep);
  std::size_t outliers = 0;
  for (int i = 0; i < 6000; ++i) {
    const double reading = motion.first_reading + 0.1 * (i / 300);
    Vector3 p_S = motion.at(reading) + test::kSweepSigma_m * random.normal_vector();
    if (random.uniform(0, 1) < 0.2) {
      p_S += random.uniform(0.02, 0.3) * random.direction();
      ++outliers;
    }
    ASSERT_TRUE(estimator.add(reading, p_S, test::isotropic(test::kSweepSigma_m)));
  }
  const auto feature = estimator.estimate();
  ASSERT_TRUE(feature);
  EXPECT_GE(feature->quality.rejected, outliers);
  EXPECT_LE(feature->quality.rejected, outliers + 5);
  EXPECT_EQ(feature->quality.used + feature->quality.rejected, 6000U);
  EXPECT_LT(test::feature_error(*feature, motion).norm(), 1e-4);
}

}  // namespace
}  // namespace armsig::features
