// SPDX-License-Identifier: MIT
// The fits themselves, on points that no gate has touched.
#include <cmath>

#include <gtest/gtest.h>

#include "core/features/centre_of_rotation.hpp"
#include "core/features/encoder_circle.hpp"
#include "core/features/encoder_line.hpp"
#include "core/features/encoder_ratio.hpp"
#include "core/features/line_of_translation.hpp"
#include "core/features/paper_fit.hpp"
#include "core/features/plane_of_rotation.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/simulated_sweep.hpp"

namespace armsig::features {
namespace {

struct Row {
  double reading;
  double p_S[3];
};

// A noisy circle (sigma 0.2 mm) about (0.3, -0.2, 2.5), radius 0.4, over 99 degrees.
constexpr Row kNoisyCircle[] = {
    {12.00000, {0.12111, -0.55771, 2.49995}}, {12.15708, {0.13535, -0.55956, 2.43874}},
    {12.31416, {0.15401, -0.55206, 2.37927}}, {12.47124, {0.17593, -0.53640, 2.32285}},
    {12.62832, {0.20119, -0.51257, 2.27055}}, {12.78540, {0.22885, -0.48085, 2.22388}},
    {12.94248, {0.25764, -0.44213, 2.18382}}, {13.09956, {0.28830, -0.39746, 2.15224}},
    {13.25664, {0.31900, -0.34772, 2.12824}}, {13.41372, {0.34902, -0.29453, 2.11447}},
    {13.57080, {0.37777, -0.23913, 2.10944}}, {13.72788, {0.40493, -0.18238, 2.11428}},
};

SweepStatistics noisy_circle() {
  SweepStatistics statistics;
  for (const Row& row : kNoisyCircle) {
    const SweepPoint point{row.reading, Vector3(row.p_S), test::isotropic(2e-4)};
    if (statistics.count == 0) statistics = SweepStatistics(JointType::kRevolute, point);
    statistics.add(point);
  }
  return statistics;
}

SweepStatistics exact(const test::TrueMotion& motion, double range, std::size_t count) {
  SweepStatistics statistics;
  for (std::size_t i = 0; i < count; ++i) {
    const double reading = test::even_reading(motion, range, i, count);
    const SweepPoint point{reading, motion.at(reading), Matrix3::Identity()};
    if (i == 0) statistics = SweepStatistics(motion.type, point);
    statistics.add(point);
  }
  return statistics;
}

test::TrueMotion circle_about(const Vector3& axis) {
  test::TrueMotion motion;
  motion.point_S = Vector3(0.1, -0.2, 2.5);
  motion.radius_m = 0.5;
  motion.R_SC.col(0) = any_perpendicular(axis);
  motion.R_SC.col(1) = axis.cross(motion.R_SC.col(0));
  motion.R_SC.col(2) = axis;
  return motion;
}

// Golden values: numpy.linalg.lstsq over the points themselves, with x as the regressed coordinate.
TEST(PlaneOfRotation, is_the_regression_13_with_the_pivot_nearest_to_the_normal) {
  const auto plane = plane_of_rotation(noisy_circle().geometry.matrix());
  ASSERT_TRUE(plane);
  const Vector3 normal(0.873171586686611, -0.4353601480524273, 0.21916414326014846);
  EXPECT_LT((plane->normal_S - normal).norm(), 1e-11);
  EXPECT_NEAR(plane->distance_m + normal.dot(Vector3(kNoisyCircle[0].p_S)), 0.8963469150088447,
              1e-11);
}

// Golden values: the points projected onto that plane, (14) by numpy.linalg.lstsq.
TEST(CentreOfRotation, is_the_regression_14_of_the_projected_points) {
  const SweepStatistics statistics = noisy_circle();
  const auto plane = plane_of_rotation(statistics.geometry.matrix());
  ASSERT_TRUE(plane);
  const auto circle = centre_of_rotation(statistics.geometry.matrix(), *plane);
  ASSERT_TRUE(circle);
  const Vector3 centre(0.29947236110749104, -0.20003694879745362, 2.499350644221093);
  EXPECT_LT((statistics.origin_S + circle->centre - centre).norm(), 1e-11);
  EXPECT_NEAR(circle->radius_m, 0.39962650518295206, 1e-11);
}

// Golden values: Gauss-Newton over all 36 coordinates in numpy, derivatives by differences.
TEST(EncoderCircle, is_the_circle_of_greatest_likelihood) {
  const auto circle = encoder_circle(noisy_circle());
  ASSERT_TRUE(circle);
  EXPECT_LT(
      (circle->centre_S - Vector3(0.2995221173974666, -0.1997535651210524, 2.4997130809861177))
          .norm(),
      1e-10);
  EXPECT_LT(
      (circle->R_SC.col(2) - Vector3(0.8731716716261919, -0.43535935933912345, 0.2191653715926609))
          .norm(),
      1e-10);
  EXPECT_LT((circle->R_SC.col(0) -
             Vector3(-0.44631397900029585, -0.89487627759540711, 0.00052909915132691855))
                .norm(),
            1e-10);
  EXPECT_NEAR(circle->radius_m, 0.4000230630322834, 1e-10);
}

TEST(EncoderCircle, states_the_covariance_of_the_normal_equations) {
  const auto circle = encoder_circle(noisy_circle());
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
    const auto closed = encoder_circle(equal);
    const auto iterated = encoder_circle(nearly);
    ASSERT_TRUE(closed);
    ASSERT_TRUE(iterated);
    EXPECT_LT((closed->centre_S - iterated->centre_S).norm(), 1e-9);
    EXPECT_LT((closed->R_SC - iterated->R_SC).norm(), 1e-9);
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
    SweepStatistics statistics;
    for (std::size_t i = 0; i < 20; ++i) {
      const double reading = test::even_reading(motion, 2, i, 20);
      const SweepPoint point{reading, motion.at(reading) + 1e-4 * random.normal_vector(),
                             test::isotropic(1e-4)};
      if (i == 0) statistics = SweepStatistics(motion.type, point);
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
      SweepStatistics statistics;
      for (std::size_t i = 0; i < 20; ++i) {
        const double reading = test::even_reading(motion, 2, i, 20);
        const SweepPoint point{reading, motion.at(reading) + root * random.normal_vector(),
                               root * root};
        if (i == 0) statistics = SweepStatistics(motion.type, point);
        statistics.add(point);
      }
      const EncoderRatio encoder = encoder_ratio(statistics);
      squares += std::pow((encoder.ratio - 1) / encoder.sigma, 2);
    }
    EXPECT_NEAR(squares / 500, 1, 0.25) << degrees(angle);
  }
}

TEST(PlaneOfRotation, may_contain_the_sensors_z_axis) {
  for (const Vector3& axis : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1),
                              Vector3(0.6, 0.8, 0), Vector3(0.6, 0, 0.8)}) {
    const auto plane = plane_of_rotation(exact(circle_about(axis), 2, 20).geometry.matrix());
    ASSERT_TRUE(plane);
    EXPECT_LT(plane->normal_S.cross(axis).norm(), 1e-14);
  }
}

// Along this short arc the points spread least in a coordinate that lies in their plane.
TEST(PlaneOfRotation, chooses_a_pivot_out_of_the_plane_on_a_short_arc) {
  test::TrueMotion motion;
  motion.radius_m = 0.5;
  motion.R_SC.col(1) = Vector3(0.57, 0.58, 0.59).normalized();  // the chord
  motion.R_SC.col(2) = Vector3(0, 0.59, -0.58).normalized();
  motion.R_SC.col(0) = motion.R_SC.col(1).cross(motion.R_SC.col(2));
  const auto plane = plane_of_rotation(exact(motion, 0.2, 20).geometry.matrix());
  ASSERT_TRUE(plane);
  EXPECT_LT(plane->normal_S.cross(motion.R_SC.col(2)).norm(), 1e-12);
}

TEST(PlaneOfRotation, of_points_on_a_line_is_refused) {
  test::TrueMotion line;
  line.type = JointType::kPrismatic;
  const auto plane = plane_of_rotation(exact(line, 1, 10).geometry.matrix());
  ASSERT_FALSE(plane);
  EXPECT_EQ(test::failure_of(plane), Error::kSingular);
}

TEST(LineOfTranslation, is_found_along_every_coordinate) {
  for (int i = 0; i < 3; ++i) {
    test::TrueMotion motion;
    motion.type = JointType::kPrismatic;
    motion.R_SC.col(2) = (Vector3::Unit(i) + Vector3(0.1, -0.05, 0.02)).normalized();
    const auto line = line_of_translation(exact(motion, 0.4, 9).geometry);
    ASSERT_TRUE(line);
    EXPECT_LT(line->direction_S.cross(motion.R_SC.col(2)).norm(), 1e-15);
  }
}

TEST(LineOfTranslation, of_coincident_points_is_refused) {
  SweepStatistics statistics(JointType::kPrismatic, SweepPoint{});
  for (int i = 0; i < 5; ++i) statistics.add({0.1 * i, Vector3::Zero(), Matrix3::Identity()});
  ASSERT_FALSE(line_of_translation(statistics.geometry));
  EXPECT_EQ(test::failure_of(line_of_translation(statistics.geometry)), Error::kSingular);
}

TEST(PaperCircle, turns_in_the_positive_sense_of_the_reading) {
  for (const double sense : {1.0, -1.0}) {
    const test::TrueMotion motion = circle_about(sense * Vector3(0.6, 0, 0.8));
    const auto circle = paper_circle(exact(motion, 1, 15));
    ASSERT_TRUE(circle);
    EXPECT_LT((circle->R_SC - motion.R_SC).norm(), 1e-12);
  }
}

TEST(PaperLine, points_in_the_positive_sense_of_the_reading) {
  test::TrueMotion motion;
  motion.type = JointType::kPrismatic;
  motion.R_SC.col(2) = Vector3(-0.6, 0, 0.8);
  const auto line = paper_line(exact(motion, -0.3, 7));
  ASSERT_TRUE(line);
  EXPECT_LT((line->direction_S - motion.R_SC.col(2)).norm(), 1e-15);
}

TEST(EncoderLine, ignores_the_scale_of_the_readings) {
  SweepStatistics statistics(JointType::kPrismatic, SweepPoint{});
  for (int i = -5; i <= 5; ++i) {
    const SweepPoint point{0.1 * i, Vector3(0.101 * i, 0, 0.3), Matrix3::Identity()};
    statistics.add(point);
  }
  const auto line = encoder_line(statistics);
  ASSERT_TRUE(line);
  EXPECT_LT((line->direction_S - Vector3::UnitX()).norm(), 1e-15);
  EXPECT_LT((line->point_S - Vector3(0, 0, 0.3)).norm(), 1e-15);
  EXPECT_NEAR(encoder_ratio(statistics).ratio, 1.01, 1e-14);
}

TEST(EncoderFits, of_a_single_reading_are_refused) {
  SweepStatistics statistics(JointType::kRevolute, SweepPoint{});
  for (int i = 0; i < 5; ++i) statistics.add({0, Vector3(0.1, 0.1 * i, 0), Matrix3::Identity()});
  ASSERT_FALSE(encoder_circle(statistics));
  EXPECT_EQ(test::failure_of(encoder_circle(statistics)), Error::kSingular);
  statistics.type = JointType::kPrismatic;
  ASSERT_FALSE(encoder_line(statistics));
  EXPECT_EQ(test::failure_of(encoder_line(statistics)), Error::kSingular);
}

TEST(EncoderCircle, of_a_target_that_stands_still_is_refused) {
  SweepStatistics statistics(JointType::kRevolute, SweepPoint{});
  for (int i = 0; i < 5; ++i) statistics.add({0.1 * i, Vector3::Zero(), Matrix3::Identity()});
  ASSERT_FALSE(encoder_circle(statistics));
  EXPECT_EQ(test::failure_of(encoder_circle(statistics)), Error::kSingular);
}

}  // namespace
}  // namespace armsig::features
