// SPDX-License-Identifier: MIT
// A once-per-turn error of the readings, found in the residuals of the circle that was fitted
// without knowing of it.
#include "firmware/host_tool/report/encoder_wave.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/host_tool/report/sweep_picture.hpp"

namespace armsig::tool {
namespace {

constexpr double kRadius_m = 0.3;

// A sweep whose encoder reads `amplitude` cos(reading - phase) too little.
MeasuredSweep sweep_with_wave(double amplitude_rad, double phase_rad, double arc_rad,
                              double sigma_m) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, sigma_m);
  MeasuredSweep sweep{.joint = 0, .target = 1, .points = {}};
  constexpr int kPoints = 180;
  for (int k = 0; k < kPoints; ++k) {
    const double reading = -arc_rad / 2 + arc_rad * k / (kPoints - 1);
    const double angle = reading + amplitude_rad * std::cos(reading - phase_rad);
    const Vector3 p_S(0.1 + kRadius_m * std::cos(angle) + normal(random),
                      -0.2 + kRadius_m * std::sin(angle) + normal(random), 0.5 + normal(random));
    sweep.points.push_back({reading, p_S, Matrix3::Identity() * sigma_m * sigma_m});
  }
  return sweep;
}

TEST(EncoderWave, is_found_in_full_although_the_circle_takes_up_half_of_it) {
  const double amplitude_rad = radians(0.1);
  const auto picture = picture_of(sweep_with_wave(amplitude_rad, 0.7, 2 * kPi, 5e-5),
                                  JointType::kRevolute, features::Method::kEncoder);
  ASSERT_TRUE(picture && picture->wave);
  const EncoderWave& wave = *picture->wave;
  EXPECT_TRUE(wave.significant());
  EXPECT_NEAR(wave.amplitude_rad(), amplitude_rad, 5 * wave.sigma_rad);
  EXPECT_LT(wave.sigma_rad, amplitude_rad / 20);
  EXPECT_NEAR(std::atan2(wave.sine_rad, wave.cosine_rad), 0.7, 0.1);
  // The residuals about the circle have half the amplitude.
  double largest_m = 0;
  for (int k = 0; k < 100; ++k) {
    largest_m =
        std::max(largest_m, std::abs(wave.residual_at(2 * kPi * k / 100, kRadius_m).tangential_m));
  }
  EXPECT_NEAR(largest_m, kRadius_m * amplitude_rad / 2, 0.1 * kRadius_m * amplitude_rad);
}

TEST(EncoderWave, is_not_seen_in_noise) {
  for (const double arc_rad : {1.1 * kPi, 1.6 * kPi, 2 * kPi}) {
    const auto picture = picture_of(sweep_with_wave(0, 0, arc_rad, 2e-4), JointType::kRevolute,
                                    features::Method::kEncoder);
    ASSERT_TRUE(picture && picture->wave);
    EXPECT_FALSE(picture->wave->significant()) << picture->wave->chi_square;
  }
}

TEST(EncoderWave, is_not_looked_for_within_half_a_turn_or_in_few_points) {
  const auto picture = picture_of(sweep_with_wave(radians(0.1), 0, 0.9 * kPi, 5e-5),
                                  JointType::kRevolute, features::Method::kEncoder);
  ASSERT_TRUE(picture);
  EXPECT_FALSE(picture->wave);
  const std::vector<CircleResidual> few{{0, 0, 0}, {2, 0, 0}, {4, 0, 0}};
  EXPECT_FALSE(fit_encoder_wave(few, kRadius_m));
}

TEST(SweepPicture, marks_the_points_that_the_fit_rejected) {
  MeasuredSweep sweep = sweep_with_wave(0, 0, kPi, 1e-4);
  sweep.points[17].p_S.x() += 0.03;
  sweep.points[80].p_S.z() -= 0.05;
  const auto picture = picture_of(sweep, JointType::kRevolute, features::Method::kEncoder);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->feature.quality.rejected, 2U);
  for (std::size_t k = 0; k < picture->points.size(); ++k) {
    EXPECT_EQ(picture->points[k].rejected, k == 17 || k == 80) << k;
  }
  EXPECT_NEAR(picture->points[80].normal_m, -0.05, 1e-3);
}

}  // namespace
}  // namespace armsig::tool
