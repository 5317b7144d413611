// SPDX-License-Identifier: MIT
#include "hal/cia402/scaling.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/not_finite.hpp"

namespace armsig::cia402 {
namespace {

using test::kNan;
constexpr ScalingConfiguration kShoulder{.counts_per_revolution = 4000, .gear_ratio = 100};
constexpr ScalingConfiguration kLift{
    .type = JointType::kPrismatic, .counts_per_revolution = 10000, .gear_ratio = 2, .lead_m = 0.01};

TEST(Scaling, turns_a_quarter_turn_into_a_quarter_of_the_geared_counts) {
  EXPECT_EQ(Scaling::make(kShoulder)->counts(kPi / 2), 100000);
}

TEST(Scaling, turns_a_prismatic_reading_into_counts_by_the_lead) {
  EXPECT_EQ(Scaling::make(kLift)->counts(0.5), 1'000'000);
}

TEST(Scaling, reads_back_what_it_sent_within_half_a_count) {
  ScalingConfiguration reversed = kShoulder;
  reversed.reversed = true;
  reversed.zero_counts = -12345;
  const Scaling scaling = *Scaling::make(reversed);
  for (double reading = -3; reading < 3; reading += 0.137) {
    EXPECT_NEAR(scaling.reading(*scaling.counts(reading)), reading, 0.5001 * scaling.resolution());
  }
}

TEST(Scaling, a_reversed_joint_counts_down) {
  ScalingConfiguration reversed = kShoulder;
  reversed.reversed = true;
  reversed.zero_counts = 7;
  EXPECT_EQ(Scaling::make(reversed)->counts(kPi / 2), -100000 + 7);
}

TEST(Scaling, refuses_what_does_not_fit_into_counts) {
  const Scaling scaling = *Scaling::make(kShoulder);
  const double largest = 2147483647.0 / 400000 * 2 * kPi;
  EXPECT_TRUE(scaling.counts(largest));
  EXPECT_EQ(test::failure_of(scaling.counts(largest + 2 * scaling.resolution())),
            Error::kPositionOverflow);
  EXPECT_EQ(test::failure_of(scaling.counts(-largest - 3 * scaling.resolution())),
            Error::kPositionOverflow);
  EXPECT_EQ(test::failure_of(scaling.counts(1e300)), Error::kPositionOverflow);
}

TEST(Scaling, refuses_numbers_that_are_not_finite) {
  const Scaling scaling = *Scaling::make(kShoulder);
  EXPECT_EQ(test::failure_of(scaling.counts(kNan)), Error::kNotFinite);
  EXPECT_EQ(test::failure_of(scaling.counts(HUGE_VAL)), Error::kNotFinite);
  EXPECT_EQ(test::failure_of(scaling.distance_counts(HUGE_VAL)), Error::kNotFinite);
  ScalingConfiguration configuration = kShoulder;
  configuration.gear_ratio = kNan;
  EXPECT_EQ(test::failure_of(Scaling::make(configuration)), Error::kNotFinite);
}

TEST(Scaling, refuses_factors_that_are_not_positive) {
  for (const double factor : {0.0, -1.0}) {
    ScalingConfiguration configuration = kLift;
    configuration.counts_per_revolution = factor;
    EXPECT_EQ(test::failure_of(Scaling::make(configuration)), Error::kScaleInvalid);
    configuration = kLift;
    configuration.gear_ratio = factor;
    EXPECT_EQ(test::failure_of(Scaling::make(configuration)), Error::kScaleInvalid);
    configuration = kLift;
    configuration.lead_m = factor;
    EXPECT_EQ(test::failure_of(Scaling::make(configuration)), Error::kScaleInvalid);
  }
}

TEST(Scaling, refuses_a_count_worth_more_than_a_tenth_of_a_degree) {
  ScalingConfiguration configuration = kShoulder;
  configuration.counts_per_revolution = 1;  // turns instead of counts
  EXPECT_EQ(test::failure_of(Scaling::make(configuration)), Error::kResolutionTooCoarse);
  ScalingConfiguration lift = kLift;
  lift.lead_m = 10;  // millimetres instead of metres
  EXPECT_EQ(test::failure_of(Scaling::make(lift)), Error::kResolutionTooCoarse);
}

TEST(Scaling, a_distance_has_at_least_one_count) {
  const Scaling scaling = *Scaling::make(kShoulder);
  EXPECT_EQ(scaling.distance_counts(0), 1U);
  EXPECT_EQ(scaling.distance_counts(2 * kPi), 400000U);
  EXPECT_EQ(test::failure_of(scaling.distance_counts(1e9)), Error::kPositionOverflow);
}

TEST(Scaling, refuses_factors_whose_product_is_no_number) {
  EXPECT_EQ(test::failure_of(Scaling::make({.counts_per_revolution = 1e200, .gear_ratio = 1e200})),
            Error::kScaleInvalid);
}

}  // namespace
}  // namespace armsig::cia402
