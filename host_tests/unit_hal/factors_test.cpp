// SPDX-License-Identifier: MIT
// What a drive says of its counts against what is configured.
#include "hal/cia402/factors.hpp"

#include <gtest/gtest.h>

namespace armsig::cia402 {
namespace {

constexpr ScalingConfiguration kJoint{.counts_per_revolution = 4000, .gear_ratio = 100};

Factor factor(std::uint32_t over, std::uint32_t under) { return {.over = over, .under = under}; }

TEST(Factor, is_the_quotient_of_two_numbers_above_zero) {
  EXPECT_EQ(factor(3, 2).value(), 1.5);
  EXPECT_FALSE(factor(0, 2).value());
  EXPECT_FALSE(factor(3, 0).value());
  EXPECT_FALSE((Factor{.over = 3, .under = {}}.value()));
  EXPECT_FALSE((Factor{.over = {}, .under = 2}.value()));
}

TEST(Factors, are_asked_for_in_both_parts_each_and_may_be_absent) {
  cia402::Setup setup;
  append_factor_requests(setup);
  ASSERT_EQ(setup.size(), 6U);
  DriveFactors factors;
  for (std::size_t i = 0; i < setup.size(); ++i) {
    EXPECT_EQ(setup[i].rule, SetupRule::kIfPresent);
    take_factor(setup[i].request, ObjectOutcome(static_cast<std::uint32_t>(10 + i)), factors);
  }
  EXPECT_EQ(factors.encoder.over, 10U);
  EXPECT_EQ(factors.encoder.under, 11U);
  EXPECT_EQ(factors.gear.over, 12U);
  EXPECT_EQ(factors.gear.under, 13U);
  EXPECT_EQ(factors.feed.over, 14U);
  EXPECT_EQ(factors.feed.under, 15U);
}

TEST(Factors, of_a_drive_that_does_not_tell_contradict_nothing) {
  EXPECT_FALSE(contradicting_object({}, kJoint));
}

TEST(Factors, agree_within_a_hundred_thousandth) {
  DriveFactors factors;
  factors.encoder = factor(4000, 1);
  EXPECT_FALSE(contradicting_object(factors, kJoint));
  factors.encoder = factor(400003, 100);
  EXPECT_FALSE(contradicting_object(factors, kJoint));
  for (const std::uint32_t counts : {400005U, 399995U}) {
    factors.encoder = factor(counts, 100);
    EXPECT_EQ(contradicting_object(factors, kJoint), 0x608F) << counts;
  }
}

TEST(Factors, of_a_gear_are_that_of_the_joint_or_one_to_one) {
  DriveFactors factors;
  factors.gear = factor(100, 1);
  EXPECT_FALSE(contradicting_object(factors, kJoint));
  factors.gear = factor(1, 1);
  EXPECT_FALSE(contradicting_object(factors, kJoint));
  factors.gear = factor(50, 1);
  EXPECT_EQ(contradicting_object(factors, kJoint), 0x6091);
}

// 400000 units a revolution of the output over a gear of 100: 4000 a revolution of the motor.
TEST(Factors, of_a_feed_count_before_the_encoder) {
  DriveFactors factors;
  factors.gear = factor(100, 1);
  factors.feed = factor(400000, 1);
  factors.encoder = factor(1, 1);
  EXPECT_FALSE(contradicting_object(factors, kJoint));
  factors.feed = factor(200000, 1);
  EXPECT_EQ(contradicting_object(factors, kJoint), 0x6092);
  factors.gear = {};
  factors.feed = factor(4000, 1);
  EXPECT_FALSE(contradicting_object(factors, kJoint)) << "without a gear of its own";
}

}  // namespace
}  // namespace armsig::cia402
