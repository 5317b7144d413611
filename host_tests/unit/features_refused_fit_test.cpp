// SPDX-License-Identifier: MIT
// What no feature can be fitted to, and what is left open beside one.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/features/fit_feature.hpp"
#include "core/features/gate.hpp"
#include "core/features/judging.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/measured_sweep.hpp"

namespace armsig::features {
namespace {

using test::kBothMethods;
using test::kPrismaticSweep;
using test::kRevoluteSweep;
using test::Random;

SweepStatistics gathered(JointType type, Method method, std::initializer_list<SweepPoint> points) {
  SweepStatistics statistics(type, method);
  for (const SweepPoint& point : points) statistics.add(point);
  return statistics;
}

SweepPoint at(double reading, const Vector3& p_S) { return {reading, p_S, test::isotropic(1e-4)}; }

TEST(FitFeature, of_fewer_readings_than_a_motion_has_unknowns_is_one_of_too_short_an_arc) {
  for (const Method method : kBothMethods) {
    const SweepStatistics circle =
        gathered(JointType::kRevolute, method, {at(0, {1, 0, 0}), at(0.5, {0.9, 0.5, 0})});
    const SweepStatistics line = gathered(JointType::kPrismatic, method, {at(0, {1, 0, 0})});
    for (const SweepStatistics* statistics : {&circle, &line}) {
      JointFeature feature;
      const auto refusal = fit_feature(*statistics, {}, feature);
      ASSERT_TRUE(refusal);
      EXPECT_EQ(refusal->error, Error::kArcTooShort);
      EXPECT_EQ(refusal->found, statistics->arc());
    }
  }
}

TEST(FitFeature, of_points_on_a_line_is_no_circle) {
  for (const Method method : kBothMethods) {
    const SweepStatistics statistics =
        gathered(JointType::kRevolute, method,
                 {at(0, {0, 0, 0}), at(0.5, {1, 0, 0}), at(1, {2, 0, 0}), at(1.5, {3, 0, 0})});
    JointFeature feature;
    EXPECT_TRUE(fit_feature(statistics, {}, feature));
  }
}

// A slide that stood still.
TEST(FitFeature, of_points_that_did_not_move_is_no_line) {
  for (const Method method : kBothMethods) {
    const SweepStatistics statistics = gathered(
        JointType::kPrismatic, method, {at(0, {1, 2, 3}), at(0.1, {1, 2, 3}), at(0.2, {1, 2, 3})});
    JointFeature feature;
    EXPECT_TRUE(fit_feature(statistics, {}, feature));
  }
}

// Squares, and squares of these, leave what a number can hold.
TEST(SweepEstimator, refuses_sizes_that_cannot_be_computed_with) {
  int refused = 0;
  for (const auto& config : {kRevoluteSweep, kPrismaticSweep}) {
    for (int exponent = -160; exponent <= 150; exponent += 5) {
      const double size = std::pow(10.0, exponent);
      const bool revolute = config.type == JointType::kRevolute;
      for (const Method method : kBothMethods) {
        SweepEstimator estimator(test::by(method, config));
        for (int k = 0; k < 20; ++k) {
          const double q = 0.2 * k * (revolute ? 1 : size);
          const Vector3 p_S =
              revolute ? size * Vector3(std::cos(q), std::sin(q), 1) : Vector3(q, 2, 1);
          ASSERT_TRUE(estimator.add(q, p_S, Matrix3::Zero()));
        }
        const auto feature = estimator.estimate();
        if (!feature) {
          refused += feature.error().error == Error::kNotFinite;
          continue;
        }
        EXPECT_TRUE(feature->axis_S.allFinite() && feature->point_S.allFinite()) << exponent;
        EXPECT_TRUE(feature->covariance.allFinite()) << exponent;
        const SweepQuality& quality = feature->quality;
        EXPECT_TRUE(std::isfinite(feature->radius_m + quality.sigma_m + quality.rms_normal_m +
                                  quality.rms_radial_m + quality.rms_tangential_m +
                                  quality.encoder_ratio + quality.encoder_ratio_sigma))
            << exponent;
      }
    }
  }
  EXPECT_GT(refused, 10);
}

TEST(NoiseLevel, of_points_that_leave_no_freedom_is_what_was_stated) {
  const SweepStatistics statistics =
      gathered(JointType::kPrismatic, Method::kEncoder, {at(0, {1, 0, 0}), at(0.5, {1.5, 0, 0})});
  const NoiseLevel stated = noise_level(statistics, true);
  EXPECT_FALSE(stated.is_estimated);
  EXPECT_NEAR(stated.sigma_m, 1e-4, 1e-12);
  const NoiseLevel unknown = noise_level(statistics, false);
  EXPECT_TRUE(unknown.is_estimated);
  EXPECT_LT(unknown.sigma_m, 1e-12);
}

// Without a stated sigma there is nothing to compare the target's motion with.
TEST(SweepEstimator, says_of_a_target_that_stood_still_how_far_it_would_have_to_move) {
  for (const double sigma_m : {0.0, 1e-3}) {
    SweepEstimator estimator(kRevoluteSweep);
    for (int k = 0; k < 10; ++k) {
      ASSERT_TRUE(estimator.add(0.1 * k, Vector3(1, 2, 3), test::isotropic(sigma_m)));
    }
    const Refusal refusal = test::failure_of(estimator.estimate());
    EXPECT_EQ(refusal.error, Error::kCoincidentPoints);
    EXPECT_NEAR(refusal.needed, 10 * sigma_m, 1e-12);
  }
}

// A centimetre of half a metre: the free motion fits an ellipse, the circle does not.
TEST(SweepEstimator, refuses_an_ellipse) {
  for (const double sigma_m : {1e-4, 5e-3}) {
    Random random(31);
    SweepEstimator estimator(kRevoluteSweep);
    for (int k = 0; k < 100; ++k) {
      const double q = -1.5 + 0.03 * k;
      const Vector3 p_S(0.55 * std::cos(q), 0.5 * std::sin(q), 1);
      ASSERT_TRUE(estimator.add(q, p_S + random.normal_vector(sigma_m), test::isotropic(sigma_m)));
    }
    const auto feature = estimator.estimate();
    ASSERT_FALSE(feature);
    EXPECT_EQ(test::failure_of(feature).error, Error::kNotACircle);
  }
}

// What noise alone may look like is no ellipse.
TEST(SweepEstimator, takes_a_coarse_circle_whose_readings_miss_by_chance) {
  const auto motion = test::some_motion(JointType::kRevolute, 0.3);
  const SweepEstimator estimator = test::measured(kRevoluteSweep, {motion, 3, 20, 0.01, 0.01});
  EXPECT_TRUE(estimator.estimate());
}

TEST(SweepEstimator, asks_for_another_radius_where_no_arc_would_do) {
  const auto near = test::some_motion(JointType::kRevolute, 0.5 * kNextToAxis_m);
  const auto next_to_axis = test::measured(kRevoluteSweep, {near, 0.6, 100, 2e-4, 2e-4}).estimate();
  ASSERT_FALSE(next_to_axis);
  EXPECT_EQ(test::failure_of(next_to_axis).error, Error::kRadiusTooSmall);
  EXPECT_GT(test::failure_of(next_to_axis).needed, test::failure_of(next_to_axis).found);
  const auto far = test::some_motion(JointType::kRevolute, 0.1);
  const auto noisy = test::measured(kRevoluteSweep, {far, 5, 8, 9e-3, 9e-3}).estimate();
  ASSERT_FALSE(noisy);
  EXPECT_EQ(test::failure_of(noisy).error, Error::kRadiusTooSmall);
}

TEST(SweepEstimation, is_over_once) {
  const auto motion = test::some_motion(JointType::kRevolute);
  const SweepEstimator estimator = test::measured(kRevoluteSweep, {motion, 1.5, 20});
  SweepEstimation estimation(estimator);
  while (estimation.step()) {
  }
  const JointFeature before = *estimation.result();
  EXPECT_FALSE(estimation.step());
  EXPECT_EQ(estimation.result()->radius_m, before.radius_m);
}

TEST(GateScale, of_points_without_freedom_is_that_of_the_stated_sigma_or_none) {
  MotionStatistics accepted(JointType::kPrismatic, at(0, {0, 0, 0}));
  accepted.add(at(0, {0, 0, 0}));
  EXPECT_EQ(gate_scale(accepted, true).variance, 1);
  EXPECT_EQ(gate_scale(accepted, false).variance, 0);
  EXPECT_EQ(gate_scale(accepted, false).limit, std::numeric_limits<double>::infinity());
  EXPECT_FALSE(is_consistent(accepted));
  accepted.add(at(1, {1, 0, 0}));
  EXPECT_FALSE(is_consistent(accepted)) << "two points agree with any line";
  accepted.add(at(2, {2, 0, 0}));
  EXPECT_TRUE(is_consistent(accepted));
}

TEST(Judging, of_no_points_is_over_and_stays_so) {
  const MotionStatistics accepted(JointType::kPrismatic, at(0, {0, 0, 0}));
  Judging judging(accepted, true, {});
  EXPECT_FALSE(judging.step());
  EXPECT_FALSE(judging.step());
  EXPECT_FALSE(judging.result()[0]);
}

// Against the difference of features whose parameters are a little off.
TEST(TargetCovariance, is_that_of_the_parameters_carried_to_the_target) {
  JointFeature feature;
  feature.point_S = Vector3(1, 2, 3);
  feature.radius_m = 0.5;
  feature.covariance.setZero();
  feature.covariance(6, 6) = 4e-8;                                    // radius: 0.2 mm
  feature.covariance.block<3, 3>(0, 0).diagonal().setConstant(1e-8);  // point: 0.1 mm
  const Matrix3 at_zero = feature.target_covariance_at(0);
  EXPECT_NEAR(at_zero(0, 0), 5e-8, 1e-20);
  EXPECT_NEAR(at_zero(1, 1), 1e-8, 1e-20);
  const Matrix3 at_quarter = feature.target_covariance_at(kPi / 2);
  EXPECT_NEAR(at_quarter(1, 1), 5e-8, 1e-20);
  feature.type = JointType::kPrismatic;
  feature.radius_m = 0;
  EXPECT_TRUE(feature.target_covariance_at(0.3).isApprox(1e-8 * Matrix3::Identity(), 1e-12));
}

// What spares the quantile must not decide otherwise.
TEST(ExceedsNoise, begins_at_the_quantile_of_chi_square) {
  for (const double freedom : {1.0, 2.0, 3.0, 6.0, 15.0, 99.0, 1071.0, 1e5}) {
    const double limit = numerics::chi_square_quantile(freedom, numerics::kReadingRefused);
    EXPECT_FALSE(exceeds_noise(freedom, freedom));
    EXPECT_FALSE(exceeds_noise(limit * (1 - 1e-6), freedom)) << freedom;
    EXPECT_TRUE(exceeds_noise(limit * (1 + 1e-6), freedom)) << freedom;
  }
}

// The free motion is as fast as ten sigmas, its circle smaller: the readings run ahead.
TEST(SweepEstimator, refuses_a_circle_that_is_smaller_than_its_motion_was_fast) {
  constexpr double kSigma_m = 1e-3;
  SweepEstimator estimator(test::by(Method::kPaper, kRevoluteSweep));
  for (int k = 0; k < 60; ++k) {
    const double q = 0.1 * k;
    const double turned = 1.1 * q;
    const Vector3 p_S = 9.6 * kSigma_m * Vector3(std::cos(turned), std::sin(turned), 0);
    ASSERT_TRUE(estimator.add(q, p_S, test::isotropic(kSigma_m)));
  }
  EXPECT_FALSE(estimator.estimate());
}

}  // namespace
}  // namespace armsig::features
