// SPDX-License-Identifier: MIT
// What a drive says of its counts against what is configured.
#include "hal/cia402/factors.hpp"

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::cia402 {
namespace {

constexpr ScalingConfiguration kJoint{.counts_per_revolution = 4000, .gear_ratio = 100};

std::uint16_t contradiction(const DriveFactors& factors) {
  const auto object = contradicting_object(factors, kJoint);
  return object ? object->index : std::uint16_t{0};
}

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
  ASSERT_EQ(setup.size(), 10U);
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
  EXPECT_EQ(factors.position.over, 16U);
  EXPECT_EQ(factors.position.under, 17U);
  EXPECT_EQ(factors.position_unit, 18U);
  EXPECT_EQ(factors.acceleration_unit, 19U);
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
    EXPECT_EQ(contradiction(factors), 0x608F) << counts;
  }
}

TEST(Factors, of_a_gear_are_that_of_the_joint_or_one_to_one) {
  DriveFactors factors;
  factors.gear = factor(100, 1);
  EXPECT_FALSE(contradicting_object(factors, kJoint));
  factors.gear = factor(1, 1);
  EXPECT_FALSE(contradicting_object(factors, kJoint));
  factors.gear = factor(50, 1);
  EXPECT_EQ(contradiction(factors), 0x6091);
}

// 400000 units a revolution of the output over a gear of 100: 4000 a revolution of the motor.
TEST(Factors, of_a_feed_count_before_the_encoder) {
  DriveFactors factors;
  factors.gear = factor(100, 1);
  factors.feed = factor(400000, 1);
  factors.encoder = factor(1, 1);
  EXPECT_FALSE(contradicting_object(factors, kJoint));
  factors.feed = factor(200000, 1);
  EXPECT_EQ(contradiction(factors), 0x6092);
  factors.gear = {};
  factors.feed = factor(4000, 1);
  EXPECT_FALSE(contradicting_object(factors, kJoint)) << "without a gear of its own";
}

TEST(Factors, tell_what_was_found_and_what_was_wanted) {
  DriveFactors factors;
  factors.encoder = factor(2000, 1);
  EXPECT_EQ(contradicting_object(factors, kJoint),
            (hal::DeviceObject{.index = 0x608F, .subindex = 1, .found = 2000, .wanted = 4000}));
}

// 00B50000h: increments, so that a feed of 1/1 is of no account.
TEST(Factors, of_a_drive_that_counts_in_increments_are_the_encoders_whatever_its_feed) {
  DriveFactors factors;
  factors.position_unit = 0x00B50000;
  factors.encoder = factor(4000, 1);
  factors.gear = factor(1, 1);
  factors.feed = factor(1, 1);
  EXPECT_EQ(contradiction(factors), 0);
  factors.encoder = factor(2000, 1);
  EXPECT_EQ(contradiction(factors), 0x608F);
}

// FD410000h: thousandths of a degree, 360000 a turn; FC410000h: ten times as fine.
TEST(Factors, of_an_angle_are_its_units_in_a_turn_of_the_motor_or_of_the_output) {
  ScalingConfiguration joint = kJoint;
  joint.counts_per_revolution = 360'000;
  DriveFactors factors;
  factors.position_unit = 0xFD410000;
  EXPECT_FALSE(contradicting_object(factors, joint));
  factors.gear = factor(100, 1);
  joint.counts_per_revolution = 3600;
  EXPECT_FALSE(contradicting_object(factors, joint));
  factors.position_unit = 0xFC410000;
  ASSERT_TRUE(contradicting_object(factors, joint));
  EXPECT_EQ(contradicting_object(factors, joint)->index, 0x60A8);
}

TEST(Factors, of_an_older_drive_divide_the_increments_of_its_encoder) {
  DriveFactors factors;
  factors.position = factor(1, 1);
  EXPECT_EQ(contradiction(factors), 0) << "of an encoder that it does not tell";
  factors.position = factor(2, 1);
  EXPECT_EQ(contradiction(factors), 0x6093);
  factors.encoder = factor(8000, 1);
  EXPECT_EQ(contradiction(factors), 0);
  factors.encoder = factor(4000, 1);
  EXPECT_EQ(contradiction(factors), 0x6093);
}

// A turn of the joint a second squared is 100 turns of its motor.
TEST(StopRamp, is_told_in_the_drives_own_unit) {
  DriveFactors factors;
  EXPECT_EQ(stop_ramp(factors, 2 * kPi, kJoint), 400'000U);
  factors.acceleration_unit = 0x00B55700;  // increments
  EXPECT_EQ(stop_ramp(factors, 2 * kPi, kJoint), 400'000U);
  factors.acceleration_unit = 0xFDB45700;  // thousandths of a revolution
  EXPECT_EQ(stop_ramp(factors, 2 * kPi, kJoint), 100'000U);
  factors.acceleration_unit = 0x00C00300;  // revolutions a minute, a second
  EXPECT_EQ(stop_ramp(factors, 2 * kPi, kJoint), 6000U);
  factors.acceleration_unit = 0xFD015700;  // millimetres
  EXPECT_EQ(test::failure_of(stop_ramp(factors, 2 * kPi, kJoint)), Error::kScaleInvalid);
  factors.acceleration_unit = 0xF7B55700;  // nanocounts
  EXPECT_EQ(test::failure_of(stop_ramp(factors, 2 * kPi, kJoint)), Error::kPositionOverflow);
}

}  // namespace
}  // namespace armsig::cia402
