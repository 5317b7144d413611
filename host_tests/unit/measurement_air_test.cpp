// SPDX-License-Identifier: MIT
// Air and time to range.
#include <limits>

#include <gtest/gtest.h>

#include "core/measurement/ranges.hpp"
#include "core/measurement/speed_of_sound.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::measurement {
namespace {

// Golden values: numpy, 331.3 * sqrt((t + 273.15) / 273.15).
TEST(SpeedOfSound, is_that_of_dry_air) {
  EXPECT_NEAR(*speed_of_sound(0), 331.3, 1e-12);
  EXPECT_NEAR(*speed_of_sound(20), 343.21462268256795, 1e-12);
  EXPECT_NEAR(*speed_of_sound(-20), 318.9405944323528, 1e-12);
}

TEST(SpeedOfSound, refuses_air_of_no_workshop) {
  EXPECT_EQ(test::failure_of(speed_of_sound(60.1)), Error::kTemperatureImplausible);
  EXPECT_EQ(test::failure_of(speed_of_sound(-20.1)), Error::kTemperatureImplausible);
  EXPECT_EQ(test::failure_of(speed_of_sound(-273.15)), Error::kTemperatureImplausible);
}

TEST(SpeedOfSound, refuses_what_is_not_a_number) {
  EXPECT_EQ(test::failure_of(speed_of_sound(std::numeric_limits<double>::quiet_NaN())),
            Error::kNotFinite);
  EXPECT_EQ(test::failure_of(speed_of_sound(std::numeric_limits<double>::infinity())),
            Error::kNotFinite);
}

TEST(SpeedFromReference, is_length_over_time) {
  EXPECT_NEAR(*speed_from_reference(0.686, 2e-3), 343.0, 1e-12);
}

TEST(SpeedFromReference, refuses_a_speed_of_no_workshop_air) {
  EXPECT_EQ(test::failure_of(speed_from_reference(1, 2e-3)), Error::kTemperatureImplausible);
  EXPECT_EQ(test::failure_of(speed_from_reference(1, 4e-3)), Error::kTemperatureImplausible);
  EXPECT_EQ(test::failure_of(speed_from_reference(1, 0)), Error::kTemperatureImplausible);
  EXPECT_EQ(test::failure_of(speed_from_reference(1, -3e-3)), Error::kTemperatureImplausible);
}

TEST(SpeedFromReference, refuses_what_is_not_a_number) {
  EXPECT_EQ(test::failure_of(speed_from_reference(1, std::numeric_limits<double>::quiet_NaN())),
            Error::kNotFinite);
}

TEST(Ranges, one_way_path_is_speed_times_time) {
  const Ranges ranges =
      ranges_from_times({{.seconds = 3e-3, .valid = true}}, 343.0, SoundPath::kOneWay);
  ASSERT_EQ(ranges.size(), 1U);
  EXPECT_TRUE(ranges[0].valid);
  EXPECT_NEAR(ranges[0].metres, 1.029, 1e-15);
}

TEST(Ranges, echo_travels_the_range_twice) {
  const Ranges ranges =
      ranges_from_times({{.seconds = 6e-3, .valid = true}}, 343.0, SoundPath::kEcho);
  EXPECT_NEAR(ranges[0].metres, 1.029, 1e-15);
}

TEST(Ranges, keep_their_place_where_a_receiver_heard_nothing) {
  const Ranges ranges =
      ranges_from_times({{.seconds = 1e-3, .valid = false}, {.seconds = 3e-3, .valid = true}},
                        343.0, SoundPath::kOneWay);
  ASSERT_EQ(ranges.size(), 2U);
  EXPECT_FALSE(ranges[0].valid);
  EXPECT_TRUE(ranges[1].valid);
}

TEST(Ranges, time_of_zero_is_no_measurement) {
  EXPECT_FALSE(
      ranges_from_times({{.seconds = 0, .valid = true}}, 343.0, SoundPath::kOneWay)[0].valid);
}

TEST(Ranges, trap_on_a_speed_that_is_none) {
  EXPECT_DEATH((void)ranges_from_times({}, 0.0, SoundPath::kOneWay), "");
}

}  // namespace
}  // namespace armsig::measurement
