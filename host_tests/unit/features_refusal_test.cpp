// SPDX-License-Identifier: MIT
// The estimator of a sweep: what it refuses, and with which numbers.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/features/sweep_estimator.hpp"
#include "host_tests/support/failure_of.hpp"
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

Refusal refusal(const SweepEstimator& estimator) {
  const auto feature = estimator.estimate();
  EXPECT_FALSE(feature);
  return feature ? Refusal{} : feature.error();
}

TEST(SweepEstimator, refuses_numbers_that_are_not_finite) {
  SweepEstimator estimator(kRevoluteSweep);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(test::failure_of(estimator.add(nan, Vector3::Zero(), Matrix3::Zero())),
            Error::kNotFinite);
  EXPECT_EQ(test::failure_of(estimator.add(0, Vector3(0, inf, 0), Matrix3::Zero())),
            Error::kNotFinite);
  EXPECT_EQ(test::failure_of(estimator.add(0, Vector3::Zero(), nan * Matrix3::Identity())),
            Error::kNotFinite);
  EXPECT_EQ(estimator.count(), 0U);
}

TEST(SweepEstimator, refuses_a_covariance_that_is_not_positive_definite) {
  SweepEstimator estimator(kRevoluteSweep);
  Matrix3 correlated = Matrix3::Identity();
  correlated(1, 2) = correlated(2, 1) = 1;
  for (const Matrix3& flat :
       {Matrix3(Vector3(0, 1, 1).asDiagonal()), Matrix3(Vector3(1, 0, 1).asDiagonal()),
        Matrix3(Vector3(1, 1, 0).asDiagonal()), correlated, Matrix3(-Matrix3::Identity())}) {
    EXPECT_EQ(test::failure_of(estimator.add(0, Vector3::Zero(), flat)), Error::kSingular);
  }
  EXPECT_EQ(estimator.count(), 0U);
}

TEST(SweepEstimator, numbers_too_large_to_compute_with_give_no_feature) {
  const TrueMotion motion = some_motion(JointType::kRevolute);
  for (const Method method : kBothMethods) {
    SweepEstimator estimator(by(method, kRevoluteSweep));
    for (std::size_t i = 0; i < 20; ++i) {
      const double reading = test::even_reading(motion, 1.5, i, 20);
      ASSERT_TRUE(estimator.add(reading, 1e200 * motion.at(reading), Matrix3::Zero()));
    }
    EXPECT_FALSE(estimator.estimate());
  }
}

TEST(SweepEstimator, refuses_fewer_points_than_unknowns) {
  for (const Method method : kBothMethods) {
    const Refusal r =
        refusal(measured(by(method, kRevoluteSweep), {some_motion(JointType::kRevolute), 1.5, 3}));
    EXPECT_EQ(r.error, Error::kTooFewPoints);
    EXPECT_EQ(r.found, 3);
    EXPECT_EQ(r.needed, 4);
  }
  EXPECT_EQ(refusal(SweepEstimator(kRevoluteSweep)).error, Error::kTooFewPoints);
  EXPECT_EQ(
      refusal(measured(kPrismaticSweep, {some_motion(JointType::kPrismatic, 0), 0.3, 2})).error,
      Error::kTooFewPoints);
}

TEST(SweepEstimator, refuses_two_readings_however_often_repeated) {
  SweepEstimator estimator(kRevoluteSweep);
  for (int i = 0; i < 20; ++i)
    ASSERT_TRUE(estimator.add(i % 2, Vector3(i % 2, 0, 0.01 * i), Matrix3::Zero()));
  const Refusal r = refusal(estimator);
  EXPECT_EQ(r.error, Error::kTooFewPoints);
  EXPECT_EQ(r.found, 2);
  EXPECT_EQ(r.needed, 3);
}

TEST(SweepEstimator, refuses_one_reading_repeated) {
  SweepEstimator estimator(kRevoluteSweep);
  for (int i = 0; i < 500; ++i)
    ASSERT_TRUE(
        estimator.add(0.7, Vector3(0.1, 0, 1e-4 * (i % 7)), test::isotropic(test::kSweepSigma_m)));
  const Refusal r = refusal(estimator);
  EXPECT_EQ(r.error, Error::kJointDidNotMove);
  EXPECT_EQ(r.found, 0);
  EXPECT_GT(r.needed, 0);
}

// One and a half nanoradians apart are two readings, where three are due; half of one is none.
TEST(SweepEstimator, tells_readings_apart_from_a_nanoradian_on) {
  const auto of_range = [](double range) {
    SweepEstimator estimator(kRevoluteSweep);
    for (int i = 0; i < 20; ++i)
      EXPECT_TRUE(estimator.add(range * (i % 2), Vector3(0.1 * i, 0, 1), Matrix3::Zero()));
    return refusal(estimator);
  };
  EXPECT_EQ(of_range(1.5e-9).error, Error::kTooFewPoints);
  EXPECT_EQ(of_range(0.5e-9).error, Error::kJointDidNotMove);
}

TEST(SweepEstimator, refuses_points_that_are_all_equal) {
  for (const SweepConfig& config : {kRevoluteSweep, kPrismaticSweep}) {
    SweepEstimator estimator(config);
    for (int i = 0; i < 20; ++i)
      ASSERT_TRUE(
          estimator.add(0.1 * i, Vector3(0.1, 0.2, 3), test::isotropic(test::kSweepSigma_m)));
    const Refusal r = refusal(estimator);
    EXPECT_EQ(r.error, Error::kCoincidentPoints);
    EXPECT_EQ(r.found, 0);
    EXPECT_NEAR(r.needed, 10 * test::kSweepSigma_m, 1e-15);
  }
}

TEST(SweepEstimator, refuses_a_prismatic_target_that_stays_within_the_noise) {
  TrueMotion motion = some_motion(JointType::kPrismatic, 0);
  motion.R_SC.col(2).setZero();
  const Refusal r = refusal(
      measured(kPrismaticSweep, {motion, 0.3, 20, test::kSweepSigma_m, test::kSweepSigma_m}));
  EXPECT_EQ(r.error, Error::kCoincidentPoints);
  EXPECT_NEAR(r.needed, 10 * test::kSweepSigma_m, 1e-15);
}

TEST(SweepEstimator, refuses_a_target_on_the_axis) {
  for (const double radius_m : {0.0, 1e-3}) {
    for (const Method method : kBothMethods) {
      const Refusal r = refusal(
          measured(by(method, kRevoluteSweep), {some_motion(JointType::kRevolute, radius_m), 5, 100,
                                                test::kSweepSigma_m, test::kSweepSigma_m}));
      EXPECT_EQ(r.error, Error::kRadiusTooSmall);
      EXPECT_LT(r.found, r.needed);
      EXPECT_NEAR(r.needed, 10 * test::kSweepSigma_m, 1e-15);
    }
  }
}

TEST(SweepEstimator, refuses_an_arc_below_the_least_with_both_arcs) {
  const Refusal r =
      refusal(measured(kRevoluteSweep, {some_motion(JointType::kRevolute), 0.05, 20}));
  EXPECT_EQ(r.error, Error::kArcTooShort);
  EXPECT_NEAR(r.found, 0.05, 1e-9);
  EXPECT_NEAR(r.needed, kPi / 36, 1e-15);
}

TEST(SweepEstimator, refuses_an_arc_too_short_for_its_noise_with_the_arc_that_would_do) {
  for (const Method method : kBothMethods) {
    const TrueMotion motion = some_motion(JointType::kRevolute);
    const Sweep sweep{motion, radians(8), 36, test::kSweepSigma_m, test::kSweepSigma_m};
    const Refusal r = refusal(measured(by(method, kRevoluteSweep), sweep));
    EXPECT_EQ(r.error, Error::kArcTooShort);
    EXPECT_NEAR(r.found, radians(8), 1e-9);
    EXPECT_GT(r.needed, radians(8));
    EXPECT_TRUE(measured(by(method, kRevoluteSweep),
                         {motion, 1.5 * r.needed, 36, test::kSweepSigma_m, test::kSweepSigma_m})
                    .estimate());
  }
}

TEST(SweepEstimator, refuses_a_travel_too_short_for_its_noise) {
  const Refusal r =
      refusal(measured(kPrismaticSweep, {some_motion(JointType::kPrismatic, 0), 6e-3, 9,
                                         test::kSweepSigma_m, test::kSweepSigma_m}));
  EXPECT_EQ(r.error, Error::kArcTooShort);
  EXPECT_GT(r.needed, 6e-3);
}

// Far beyond the noise of the sensor; a larger one is no encoder's.
TEST(SweepEstimator, takes_readings_that_err_as_a_sound_encoder_does_whatever_sigma_is_stated) {
  const TrueMotion motion = some_motion(JointType::kRevolute, 0.8);
  for (const double wave_rad : {radians(0.03), radians(0.1)}) {
    for (const Method method : kBothMethods) {
      test::Random random(5);
      SweepEstimator estimator(by(method, kRevoluteSweep));
      for (std::size_t i = 0; i < 60; ++i) {
        const double turned = test::even_reading(motion, 3, i, 60);
        ASSERT_TRUE(estimator.add(turned - wave_rad * std::sin(17 * turned),
                                  motion.at(turned) + 5e-6 * random.normal_vector(),
                                  test::isotropic(5e-6)));
      }
      if (wave_rad > radians(0.05)) {
        const Refusal r = refusal(estimator);
        EXPECT_EQ(r.error, Error::kNotACircle);
        EXPECT_NEAR(r.needed, 5e-4 * 0.8, 0.01 * 5e-4 * 0.8);
        continue;
      }
      const auto feature = estimator.estimate();
      ASSERT_TRUE(feature);
      EXPECT_TRUE(feature->quality.sigma_is_estimated);
      EXPECT_GT(feature->quality.sigma_m, 10 * 5e-6);  // of the wave, not of the sensor
      EXPECT_EQ(feature->quality.rejected, 0U);
      EXPECT_NEAR(feature->radius_m, 0.8, 4 * feature->quality.sigma_m);
    }
  }
}

// A twentieth of the radius, where a fiftieth is the most.
TEST(SweepEstimator, refuses_noise_that_nobody_stated_by_its_share_of_the_radius) {
  for (const double radius_m : {0.1, 2.0}) {
    const Sweep sweep{some_motion(JointType::kRevolute, radius_m), 2, 60, radius_m / 20};
    const Refusal r = refusal(measured(kRevoluteSweep, sweep));
    EXPECT_EQ(r.error, Error::kNotACircle);
    EXPECT_NEAR(r.found, radius_m / 20, 0.3 * radius_m / 20);
    EXPECT_NEAR(r.needed, radius_m / 50, 0.1 * radius_m / 50);
  }
}

TEST(SweepEstimator, refuses_when_no_circle_explains_half_of_the_points) {
  const TrueMotion motion = some_motion(JointType::kRevolute);
  test::Random random(4);
  SweepEstimator estimator(kRevoluteSweep);
  for (std::size_t i = 0; i < 100; ++i) {
    const double reading = test::even_reading(motion, 2, i, 100);
    const Vector3 p_S =
        i % 9 < 5 ? Vector3(motion.point_S + random.direction())
                  : Vector3(motion.at(reading) + test::kSweepSigma_m * random.normal_vector());
    ASSERT_TRUE(estimator.add(reading, p_S, test::isotropic(test::kSweepSigma_m)));
  }
  const Refusal r = refusal(estimator);
  EXPECT_TRUE(r.error == Error::kTooManyOutliers || r.error == Error::kNotACircle);
}

TEST(SweepEstimator, refuses_with_the_count_when_most_points_are_outliers) {
  const TrueMotion motion = some_motion(JointType::kRevolute);
  SweepConfig strict = kRevoluteSweep;
  strict.limits.greatest_rejected = 0.1;
  SweepEstimator estimator(strict);
  for (std::size_t i = 0; i < 20; ++i) {
    const double reading = test::even_reading(motion, 2, i, 20);
    const Vector3 off(i % 4 == 0 ? 0.1 : 0.0, 0, 0);
    ASSERT_TRUE(estimator.add(reading, motion.at(reading) + off, Matrix3::Zero()));
  }
  const Refusal r = refusal(estimator);
  EXPECT_EQ(r.error, Error::kTooManyOutliers);
  EXPECT_EQ(r.found, 15);
  EXPECT_EQ(r.needed, 18);
}

// Joint i + 1 turns along with joint i: about an axis across, and about one parallel to it.
TEST(SweepEstimator, refuses_a_coupled_joint) {
  const TrueMotion motion = some_motion(JointType::kRevolute);
  for (const int column : {0, 2}) {
    const Vector3 coupled_axis = motion.R_SC.col(column);
    test::Random random(9);
    SweepEstimator estimator(kRevoluteSweep);
    for (std::size_t i = 0; i < 36; ++i) {
      const double t = 2.0 * static_cast<double>(i) / 35;
      const Vector3 from_wrist = rotation_about(coupled_axis, 0.3 * t) * motion.R_SC.col(1) * 0.4;
      const Vector3 from_axis = 0.4 * motion.R_SC.col(0) + from_wrist;
      const Vector3 p_S = motion.point_S + rotation_about(motion.R_SC.col(2), t) * from_axis;
      ASSERT_TRUE(estimator.add(t, p_S + test::kSweepSigma_m * random.normal_vector(),
                                test::isotropic(test::kSweepSigma_m)));
    }
    const Refusal r = refusal(estimator);
    EXPECT_EQ(r.error, Error::kNotACircle);
    EXPECT_GT(r.found, r.needed);
  }
}

TEST(SweepEstimator, refuses_a_prismatic_reading_in_another_unit) {
  SweepEstimator estimator(kPrismaticSweep);
  for (int i = 0; i < 20; ++i)
    ASSERT_TRUE(estimator.add(0.01 * i, Vector3(0.000254 * i, 0, 1), Matrix3::Zero()));
  const Refusal r = refusal(estimator);
  EXPECT_EQ(r.error, Error::kNotACircle);
  EXPECT_NEAR(r.found, 0.0254, 1e-12);
}

TEST(SweepEstimator, refuses_a_line_where_a_circle_is_due) {
  const TrueMotion line = some_motion(JointType::kPrismatic, 0);
  const Refusal r =
      refusal(measured(kRevoluteSweep, {line, 1, 20, test::kSweepSigma_m, test::kSweepSigma_m}));
  EXPECT_EQ(r.error, Error::kNotACircle);
}

}  // namespace
}  // namespace armsig::features
