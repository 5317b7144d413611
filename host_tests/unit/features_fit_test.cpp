// SPDX-License-Identifier: MIT
// The encoder-referenced fits themselves, on points that no gate has touched.
#include <cmath>

#include <gtest/gtest.h>

#include "core/features/fit_feature.hpp"
#include "core/features/motion_fits.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/fitted_points.hpp"

namespace armsig::features {
namespace {

using test::circle_about;
using test::fitted_by;
using test::noisy_circle;

// Golden values: Gauss-Newton over all 36 coordinates in numpy, derivatives by differences.
TEST(EncoderCircle, is_the_circle_of_greatest_likelihood) {
  const auto circle = fitted_by(encoder_circle, noisy_circle());
  ASSERT_TRUE(circle);
  EXPECT_LT((circle->point_S - Vector3(0.2995221173974666, -0.1997535651210524, 2.4997130809861177))
                .norm(),
            1e-10);
  EXPECT_LT((circle->axis_S - Vector3(0.8731716716261919, -0.43535935933912345, 0.2191653715926609))
                .norm(),
            1e-10);
  EXPECT_LT((circle->radial_S -
             Vector3(-0.44631397900029585, -0.89487627759540711, 0.00052909915132691855))
                .norm(),
            1e-10);
  EXPECT_NEAR(circle->radius_m, 0.4000230630322834, 1e-10);
}

TEST(EncoderCircle, states_the_covariance_of_the_normal_equations) {
  const auto circle = fitted_by(encoder_circle, noisy_circle());
  ASSERT_TRUE(circle);
  const double sigmas[] = {0.00036194683083106, 0.00020528137905617, 0.0001420941143081,
                           0.00060460699222977, 0.00076217627637768, 0.00078108078332905,
                           0.00011287132883342};
  for (int i = 0; i < 7; ++i)
    EXPECT_NEAR(std::sqrt(circle->covariance(i, i)), sigmas[i], 1e-8) << "parameter " << i;
  EXPECT_NEAR(circle->covariance(0, 3), 1.8386091273583185e-07, 1e-12);
  EXPECT_NEAR(circle->covariance(2, 6), 8.118128291421179e-09, 1e-13);
}

// Points as good in all directions have a closed form; a thousand-millionth more along one
// coordinate takes them through Gauss-Newton.
TEST(EncoderCircle, of_equally_good_directions_is_that_of_nearly_equal_ones) {
  for (const double arc : {0.1, 1.0, 4.0}) {
    test::Random random(9);
    const test::TrueMotion motion = circle_about(Vector3(0.6, 0, 0.8));
    MotionStatistics equal;
    MotionStatistics nearly;
    for (std::size_t i = 0; i < 25; ++i) {
      const double reading = test::even_reading(motion, arc, i, 25);
      const Vector3 p_S = motion.at(reading) + 1e-5 * random.normal_vector();
      SweepPoint point{reading, p_S, test::isotropic(1e-5)};
      if (i == 0) equal = nearly = MotionStatistics(motion.type, point);
      equal.add(point);
      point.covariance_m2(2, 2) *= 1 + 1e-9;
      nearly.add(point);
    }
    const auto closed = fitted_by(encoder_circle, equal);
    const auto iterated = fitted_by(encoder_circle, nearly);
    ASSERT_TRUE(closed);
    ASSERT_TRUE(iterated);
    EXPECT_LT((closed->point_S - iterated->point_S).norm(), 1e-9);
    EXPECT_LT((closed->axis_S - iterated->axis_S).norm(), 1e-9);
    EXPECT_LT((closed->radial_S - iterated->radial_S).norm(), 1e-9);
    EXPECT_NEAR(closed->radius_m, iterated->radius_m, 1e-9);
    EXPECT_TRUE(closed->covariance.isApprox(iterated->covariance, 1e-6)) << arc;
  }
}

TEST(EncoderRatio, is_that_of_the_unconstrained_fit) {
  EXPECT_NEAR(encoder_ratio(noisy_circle()).ratio, 1.000592914686937, 1e-12);
}

TEST(EncoderRatio, states_its_sigma) {
  test::Random random(8);
  const test::TrueMotion motion = circle_about(Vector3::UnitX());
  double squares = 0;
  double stated = 0;
  for (int trial = 0; trial < 500; ++trial) {
    SweepStatistics statistics(motion.type, Method::kEncoder);
    for (std::size_t i = 0; i < 20; ++i) {
      const double reading = test::even_reading(motion, 2, i, 20);
      const SweepPoint point{reading, motion.at(reading) + 1e-4 * random.normal_vector(),
                             test::isotropic(1e-4)};
      statistics.add(point);
    }
    const EncoderRatio encoder = encoder_ratio(statistics);
    squares += std::pow((encoder.ratio - 1) / encoder.sigma, 2);
    stated = encoder.sigma;
  }
  EXPECT_GT(stated, 0);
  EXPECT_NEAR(squares / 500, 1, 0.25);  // 4 sigma of a mean of 500 squares
}

// The two radii of the ratio share their noise where that is stronger in one direction.
TEST(EncoderRatio, states_its_sigma_under_noise_that_is_stronger_in_one_direction) {
  test::Random random(9);
  const test::TrueMotion motion = circle_about(Vector3::UnitX());
  for (const double angle : {kPi / 4, -kPi / 4}) {
    const Vector3 strong = rotation_x(angle) * Vector3::UnitY();
    const Matrix3 root = 1e-5 * Matrix3::Identity() + 3e-4 * strong * strong.transpose();
    double squares = 0;
    for (int trial = 0; trial < 500; ++trial) {
      SweepStatistics statistics(motion.type, Method::kEncoder);
      for (std::size_t i = 0; i < 20; ++i) {
        const double reading = test::even_reading(motion, 2, i, 20);
        const SweepPoint point{reading, motion.at(reading) + root * random.normal_vector(),
                               root * root};
        statistics.add(point);
      }
      const EncoderRatio encoder = encoder_ratio(statistics);
      squares += std::pow((encoder.ratio - 1) / encoder.sigma, 2);
    }
    EXPECT_NEAR(squares / 500, 1, 0.25) << degrees(angle);
  }
}

TEST(EncoderLine, ignores_the_scale_of_the_readings) {
  MotionStatistics statistics(JointType::kPrismatic, {});
  for (int i = -5; i <= 5; ++i) {
    const SweepPoint point{0.1 * i, Vector3(0.101 * i, 0, 0.3), Matrix3::Identity()};
    statistics.add(point);
  }
  const auto line = fitted_by(encoder_line, statistics);
  ASSERT_TRUE(line);
  EXPECT_LT((line->axis_S - Vector3::UnitX()).norm(), 1e-15);
  EXPECT_LT((line->point_S - Vector3(0, 0, 0.3)).norm(), 1e-15);
  EXPECT_NEAR(encoder_ratio(statistics).ratio, 1.01, 1e-14);
}

TEST(EncoderFits, of_a_single_reading_are_refused) {
  SweepStatistics statistics(JointType::kRevolute, Method::kEncoder);
  for (int i = 0; i < 5; ++i) statistics.add({0, Vector3(0.1, 0.1 * i, 0), Matrix3::Identity()});
  ASSERT_FALSE(fitted_by(encoder_circle, statistics));
  EXPECT_EQ(test::failure_of(fitted_by(encoder_circle, statistics)), Error::kSingular);
  statistics.type = JointType::kPrismatic;
  ASSERT_FALSE(fitted_by(encoder_line, statistics));
  EXPECT_EQ(test::failure_of(fitted_by(encoder_line, statistics)), Error::kSingular);
}

TEST(EncoderCircle, of_a_target_that_stands_still_is_refused) {
  SweepStatistics statistics(JointType::kRevolute, Method::kEncoder);
  for (int i = 0; i < 5; ++i) statistics.add({0.1 * i, Vector3::Zero(), Matrix3::Identity()});
  ASSERT_FALSE(fitted_by(encoder_circle, statistics));
  EXPECT_EQ(test::failure_of(fitted_by(encoder_circle, statistics)), Error::kSingular);
}

}  // namespace
}  // namespace armsig::features
