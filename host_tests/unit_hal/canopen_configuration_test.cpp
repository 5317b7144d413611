// SPDX-License-Identifier: MIT
#include <chrono>
#include <limits>

#include <gtest/gtest.h>

#include "hal/canopen/configuration.hpp"
#include "hal/cia402/setup.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_drives.hpp"

namespace armsig::canopen {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using test::puma_axis;
using test::puma_drives;

ConfigurationRefusal refusal_of(const Configuration& configuration) {
  const auto checked = check(configuration);
  EXPECT_FALSE(checked);
  return checked ? ConfigurationRefusal{} : checked.error();
}

// 47 + 8 s bits with floor((34 + 8 s - 1) / 4) stuff bits, worked out by hand.
TEST(BusLoad, counts_the_worst_case_bits_of_a_frame) {
  EXPECT_EQ(worst_case_bits(0), 55U);
  EXPECT_EQ(worst_case_bits(1), 65U);
  EXPECT_EQ(worst_case_bits(6), 115U);
  EXPECT_EQ(worst_case_bits(8), 135U);
}

// SYNC 55 + 12 PDOs of 115 = 1435 bits in 2000, and seven heartbeats of 65 in 50000.
TEST(BusLoad, six_axes_at_500_Hz_take_about_1400_microseconds_a_cycle) {
  EXPECT_NEAR(periodic_load(puma_drives()), 1435.0 / 2000 + 455.0 / 50000, 1e-12);
  EXPECT_TRUE(check(puma_drives()));
}

TEST(Configuration, accepts_the_six_drives_and_keeps_their_load) {
  EXPECT_NEAR(check(puma_drives())->bus_load(), 0.7266, 1e-9);
}

TEST(Configuration, refuses_eight_axes_at_500_Hz_as_too_much_for_the_bus) {
  const ConfigurationRefusal refusal = refusal_of(puma_drives(8));
  EXPECT_EQ(refusal.error, Error::kBusOverload);
  EXPECT_NEAR(refusal.found, 1895.0 / 2000 + 9 * 65.0 / 50000, 1e-12);
  EXPECT_EQ(refusal.needed, 0.80);
}

TEST(Configuration, refuses_a_sensor_that_overloads_the_bus) {
  Configuration configuration = puma_drives();
  configuration.others[0].traffic.push_back({8, milliseconds(1)});
  EXPECT_EQ(refusal_of(configuration).error, Error::kBusOverload);
}

TEST(Configuration, accepts_eight_axes_at_250_Hz) {
  Configuration configuration = puma_drives(8);
  configuration.period = milliseconds(4);
  EXPECT_TRUE(check(configuration));
}

TEST(Configuration, refuses_an_arm_without_axes) {
  EXPECT_EQ(refusal_of({}).error, Error::kTooFewAxes);
}

TEST(Configuration, refuses_a_node_twice_and_names_the_axis) {
  Configuration configuration = puma_drives();
  configuration.axes[3].node = 2;
  const ConfigurationRefusal refusal = refusal_of(configuration);
  EXPECT_EQ(refusal.error, Error::kNodeTwice);
  EXPECT_EQ(refusal.axis, 3U);
  EXPECT_EQ(refusal.found, 2);
}

TEST(Configuration, refuses_a_drive_at_the_masters_or_the_sensors_node) {
  Configuration configuration = puma_drives();
  configuration.axes[0].node = 127;
  EXPECT_EQ(refusal_of(configuration).error, Error::kNodeTwice);
  configuration = puma_drives();
  configuration.others[0].nodes.push_back(6);
  EXPECT_EQ(refusal_of(configuration).error, Error::kNodeTwice);
}

TEST(Configuration, refuses_nodes_0_and_128) {
  for (const NodeId node : {NodeId{0}, NodeId{128}}) {
    Configuration configuration = puma_drives();
    configuration.axes[5].node = node;
    EXPECT_EQ(refusal_of(configuration).error, Error::kNodeOutOfRange);
    EXPECT_EQ(refusal_of(configuration).axis, 5U);
  }
}

TEST(Configuration, refuses_reversed_and_empty_limits) {
  Configuration configuration = puma_drives();
  configuration.axes[1].limits = {1, -1};
  EXPECT_EQ(refusal_of(configuration).error, Error::kLimitsReversed);
  EXPECT_EQ(refusal_of(configuration).axis, 1U);
  configuration.axes[1].limits = {1, 1};
  EXPECT_EQ(refusal_of(configuration).error, Error::kLimitsReversed);
}

TEST(Configuration, refuses_limits_in_degrees_or_millimetres) {
  Configuration configuration = puma_drives();
  configuration.axes[2].limits = {-170, 170};
  EXPECT_EQ(refusal_of(configuration).error, Error::kLimitsImplausible);
  configuration = puma_drives();
  configuration.axes[2].scaling.type = JointType::kPrismatic;
  configuration.axes[2].scaling.lead_m = 0.02;
  configuration.axes[2].limits = {100, 900};
  EXPECT_EQ(refusal_of(configuration).error, Error::kLimitsImplausible);
}

TEST(Configuration, refuses_counts_per_revolution_of_zero) {
  Configuration configuration = puma_drives();
  configuration.axes[4].scaling.counts_per_revolution = 0;
  EXPECT_EQ(refusal_of(configuration).error, Error::kScaleInvalid);
  EXPECT_EQ(refusal_of(configuration).axis, 4U);
}

TEST(Configuration, refuses_limits_beyond_32_bit_counts) {
  Configuration configuration = puma_drives();
  configuration.axes[0].scaling.counts_per_revolution = 1 << 24;
  configuration.axes[0].scaling.gear_ratio = 1000;
  EXPECT_EQ(refusal_of(configuration).error, Error::kPositionOverflow);
}

TEST(Configuration, refuses_numbers_that_are_not_finite) {
  Configuration configuration = puma_drives();
  configuration.axes[0].limits.upper = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal_of(configuration).error, Error::kNotFinite);
  configuration = puma_drives();
  configuration.axes[0].largest_speed = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal_of(configuration).error, Error::kNotFinite);
}

TEST(Configuration, refuses_periods_that_the_wire_cannot_carry) {
  Configuration configuration = puma_drives();
  configuration.period = microseconds(2003);
  EXPECT_EQ(refusal_of(configuration).error, Error::kPeriodInvalid);
  configuration = puma_drives();
  configuration.heartbeat = microseconds(1500);
  EXPECT_EQ(refusal_of(configuration).error, Error::kPeriodInvalid);
  configuration = puma_drives();
  configuration.heartbeat_timeout = configuration.heartbeat;
  EXPECT_EQ(refusal_of(configuration).error, Error::kPeriodInvalid);
}

TEST(Configuration, refuses_a_speed_of_zero_no_attempts_and_an_odd_bit_rate) {
  Configuration configuration = puma_drives();
  configuration.axes[0].largest_speed = 0;
  EXPECT_EQ(refusal_of(configuration).error, Error::kPeriodInvalid);
  configuration = puma_drives();
  configuration.sdo_attempts = 0;
  EXPECT_EQ(refusal_of(configuration).error, Error::kPeriodInvalid);
  configuration = puma_drives();
  configuration.bits_per_second = 0;
  EXPECT_EQ(refusal_of(configuration).error, Error::kPeriodInvalid);
}

TEST(InterpolationPeriod, takes_the_coarsest_power_of_ten_that_fits) {
  EXPECT_EQ(cia402::interpolation_period(milliseconds(2))->value, 2);
  EXPECT_EQ(cia402::interpolation_period(milliseconds(2))->exponent, -3);
  EXPECT_EQ(cia402::interpolation_period(microseconds(2500))->value, 25);
  EXPECT_EQ(cia402::interpolation_period(microseconds(2500))->exponent, -4);
  EXPECT_EQ(cia402::interpolation_period(microseconds(250))->value, 25);
  EXPECT_EQ(cia402::interpolation_period(microseconds(250))->exponent, -5);
  EXPECT_FALSE(cia402::interpolation_period(milliseconds(256)));
  EXPECT_FALSE(cia402::interpolation_period(microseconds(50)));
  EXPECT_FALSE(cia402::interpolation_period(milliseconds(0)));
}

TEST(Configuration, refuses_a_heartbeat_shorter_than_its_milliseconds_count) {
  Configuration configuration = puma_drives(1);
  configuration.period = microseconds(500);
  configuration.heartbeat = microseconds(500);
  EXPECT_EQ(test::failure_of(check(configuration)).error, Error::kPeriodInvalid);
}

}  // namespace
}  // namespace armsig::canopen
