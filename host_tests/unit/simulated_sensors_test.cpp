// SPDX-License-Identifier: MIT
#include <cmath>

#include <gtest/gtest.h>

#include "hal/simulated/cartesian_sensor.hpp"
#include "hal/simulated/ultrasonic_field.hpp"

namespace armsig::simulated {
namespace {

Vector3 target_S() { return {3, 4, 0}; }  // 5 m from the origin

UltrasonicConfig one_receiver() {
  UltrasonicConfig config;
  config.receivers_S = {Vector3::Zero()};
  return config;
}

TEST(UltrasonicField, time_of_flight_is_that_of_sound_in_dry_air) {
  // 5 m at 343.21462268256795 m/s (numpy, 20 degrees Celsius) take 14568143.9 ns.
  UltrasonicField field(one_receiver(), Random(1));
  const Sounding sounding = field.measure(target_S());
  ASSERT_EQ(sounding.time_ns.size(), 1U);
  EXPECT_TRUE(sounding.valid[0]);
  EXPECT_EQ(sounding.time_ns[0], std::lround(5e9 / 343.21462268256795));
  EXPECT_NEAR(sounding.range_m[0], 5, 1e-15);
  EXPECT_EQ(sounding.air_celsius, 20);
}

TEST(UltrasonicField, echo_takes_twice_the_time) {
  UltrasonicConfig config = one_receiver();
  config.echo = true;
  UltrasonicField field(config, Random(1));
  const Sounding sounding = field.measure(target_S());
  EXPECT_EQ(sounding.time_ns[0], std::lround(1e10 / 343.21462268256795));
  EXPECT_NEAR(sounding.range_m[0], 5, 1e-15);
}

TEST(UltrasonicField, thermometer_error_changes_the_scale_of_the_ranges_not_the_times) {
  UltrasonicConfig config = one_receiver();
  config.thermometer_error_kelvin = 1;
  UltrasonicField field(config, Random(1));
  const Sounding sounding = field.measure(target_S());
  EXPECT_EQ(sounding.time_ns[0], std::lround(5e9 / 343.21462268256795));
  EXPECT_EQ(sounding.air_celsius, 21);
  EXPECT_NEAR(sounding.range_m[0], 5 * std::sqrt(294.15 / 293.15), 1e-14);
}

TEST(UltrasonicField, warmer_air_is_faster) {
  UltrasonicField field(one_receiver(), Random(1));
  const auto cool = field.measure(target_S()).time_ns[0];
  field.config().air_celsius = 30;
  EXPECT_LT(field.measure(target_S()).time_ns[0], cool);
}

TEST(UltrasonicField, sequence_advances_with_every_ping) {
  UltrasonicField field(one_receiver(), Random(1));
  EXPECT_EQ(field.measure(target_S()).sequence, 1);
  EXPECT_EQ(field.measure(target_S()).sequence, 2);
}

TEST(UltrasonicField, bias_belongs_to_its_receiver) {
  UltrasonicConfig config;
  config.receivers_S = {Vector3::Zero(), Vector3(3, 0, 0)};
  config.bias_m = {0, 0.002};
  UltrasonicField field(config, Random(1));
  const Sounding sounding = field.measure(target_S());
  EXPECT_NEAR(sounding.range_m[0], 5, 1e-14);
  EXPECT_NEAR(sounding.range_m[1], 4.002, 1e-14);
}

TEST(UltrasonicField, noise_scatters_as_stated) {
  UltrasonicConfig config = one_receiver();
  config.range_sigma_m = 0.2e-3;
  UltrasonicField field(config, Random(2));
  constexpr int kCount = 20'000;
  double first = 0;
  double second = 0;
  for (int i = 0; i < kCount; ++i) {
    const double error = field.measure(target_S()).range_m[0] - 5;
    first += error / kCount;
    second += error * error / kCount;
  }
  EXPECT_NEAR(first, 0, 1e-5);
  EXPECT_NEAR(std::sqrt(second), 0.2e-3, 0.01e-3);
}

TEST(UltrasonicField, detours_are_as_frequent_and_as_long_as_stated) {
  UltrasonicConfig config = one_receiver();
  config.multipath_probability = 0.2;
  UltrasonicField field(config, Random(3));
  constexpr int kCount = 10'000;
  int detours = 0;
  for (int i = 0; i < kCount; ++i) {
    const Sounding sounding = field.measure(target_S());
    const double error = sounding.range_m[0] - 5;
    if (sounding.multipath[0]) {
      ++detours;
      EXPECT_GE(error, 0.02 - 1e-12);
      EXPECT_LE(error, 0.3 + 1e-12);
    } else {
      EXPECT_NEAR(error, 0, 1e-12);
    }
  }
  EXPECT_NEAR(detours, 2000, 200);
}

TEST(UltrasonicField, dropouts_are_as_frequent_as_stated_and_invalid) {
  UltrasonicConfig config = one_receiver();
  config.dropout_probability = 0.1;
  UltrasonicField field(config, Random(4));
  int silent = 0;
  for (int i = 0; i < 10'000; ++i) {
    const Sounding sounding = field.measure(target_S());
    EXPECT_EQ(sounding.time_ns[0] == 0, !sounding.valid[0]);
    if (!sounding.valid[0]) ++silent;
  }
  EXPECT_NEAR(silent, 1000, 150);
}

TEST(UltrasonicField, same_seed_repeats_and_another_differs) {
  UltrasonicConfig config = one_receiver();
  config.range_sigma_m = 0.2e-3;
  UltrasonicField a(config, Random(5));
  UltrasonicField b(config, Random(5));
  UltrasonicField c(config, Random(6));
  const double first = a.measure(target_S()).range_m[0];
  EXPECT_EQ(first, b.measure(target_S()).range_m[0]);
  EXPECT_NE(first, c.measure(target_S()).range_m[0]);
}

TEST(UltrasonicField, noise_does_not_depend_on_how_many_detours_there_are) {
  UltrasonicConfig config = one_receiver();
  config.range_sigma_m = 0.2e-3;
  UltrasonicField clean(config, Random(5));
  config.multipath_probability = 0.5;
  UltrasonicField dirty(config, Random(5));
  for (int i = 0; i < 100; ++i) {
    const Sounding a = clean.measure(target_S());
    const Sounding b = dirty.measure(target_S());
    if (b.multipath[0]) continue;
    EXPECT_EQ(a.range_m[0], b.range_m[0]);
  }
}

TEST(UltrasonicField, traps_on_biases_of_another_array) {
  UltrasonicConfig config = one_receiver();
  config.bias_m = {0, 0};
  EXPECT_DEATH(UltrasonicField(config, Random(1)), "");
}

TEST(CartesianSensor, without_noise_tells_the_truth) {
  CartesianSensor sensor({}, Random(1));
  EXPECT_EQ(sensor.measure(target_S()).p_S, target_S());
}

TEST(CartesianSensor, noise_scatters_alike_in_all_directions) {
  CartesianSensor sensor({.sigma_m = 1e-3}, Random(2));
  constexpr int kCount = 20'000;
  Matrix3 covariance = Matrix3::Zero();
  for (int i = 0; i < kCount; ++i) {
    const Vector3 error = sensor.measure(target_S()).p_S - target_S();
    covariance += error * error.transpose() / kCount;
  }
  EXPECT_LT((covariance - 1e-6 * Matrix3::Identity()).cwiseAbs().maxCoeff(), 5e-8);
}

TEST(CartesianSensor, outliers_and_dropouts_are_as_stated) {
  CartesianSensor sensor({.dropout_probability = 0.1, .outlier_probability = 0.2}, Random(3));
  int seen = 0;
  int outliers = 0;
  for (int i = 0; i < 10'000; ++i) {
    const Sighting sighting = sensor.measure(target_S());
    if (!sighting.seen) continue;
    ++seen;
    const double error = (sighting.p_S - target_S()).norm();
    if (sighting.outlier) {
      ++outliers;
      EXPECT_GE(error, 0.02 - 1e-12);
      EXPECT_LE(error, 0.3 + 1e-12);
    } else {
      EXPECT_EQ(error, 0);
    }
  }
  EXPECT_NEAR(seen, 9000, 150);
  EXPECT_NEAR(outliers, 1800, 200);
}

}  // namespace
}  // namespace armsig::simulated
