// SPDX-License-Identifier: MIT
// What a CANopen configuration is refused for that no other test asks, from both sides of each
// bound; and the words for the abort codes of CiA 301.
#include <array>
#include <chrono>
#include <limits>
#include <set>
#include <string_view>

#include <gtest/gtest.h>

#include "hal/canopen/configuration.hpp"
#include "hal/canopen/sdo_client.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_drives.hpp"

namespace armsig::canopen {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::puma_drives;

TEST(CanopenBounds, of_times_that_somebody_waits_for) {
  using C = Configuration;
  struct Wait {
    hal::Duration C::* time;
    hal::Duration longest;
  };
  for (const Wait& wait : {Wait{&C::boot_timeout, seconds(120)}, Wait{&C::sdo_timeout, seconds(10)},
                           Wait{&C::transition_timeout, seconds(60)}}) {
    for (const bool high : {false, true}) {
      Configuration c = puma_drives();
      const hal::Duration bound = high ? wait.longest : c.period;
      c.*wait.time = bound;
      EXPECT_TRUE(check(c));
      c.*wait.time += hal::Duration(high ? 1 : -1);
      const ConfigurationRefusal refusal = test::failure_of(check(c));
      EXPECT_EQ(refusal.error, Error::kPeriodInvalid);
      EXPECT_EQ(refusal.found, hal::seconds(c.*wait.time));
      EXPECT_EQ(refusal.needed, hal::seconds(bound));
      EXPECT_FALSE(refusal.reason.empty());
    }
  }
}

TEST(CanopenBounds, of_heartbeats_are_whole_milliseconds_of_16_bits_one_shorter_than_the_other) {
  Configuration c = puma_drives();
  c.heartbeat = seconds(10);
  c.heartbeat_timeout = seconds(15);
  EXPECT_TRUE(check(c));
  c.heartbeat_timeout = seconds(10);
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kPeriodInvalid) << "not longer";
  EXPECT_EQ(test::failure_of(check(c)).needed, 10);
  c.heartbeat_timeout = milliseconds(10'001);
  EXPECT_TRUE(check(c));
  c.heartbeat_timeout = milliseconds(65'536);
  EXPECT_EQ(test::failure_of(check(c)).needed, 1e-3);
  c = puma_drives();
  c.heartbeat += std::chrono::microseconds(500);
  EXPECT_EQ(test::failure_of(check(c)).found, 0.0505);
  c = puma_drives();
  c.heartbeat = milliseconds(1);
  EXPECT_EQ(test::failure_of(check(c)).needed, 0.002) << "shorter than a tick";
}

TEST(CanopenBounds, of_what_a_drive_may_say_are_a_tick_at_least) {
  for (hal::Duration cia402::StatusLimits::* limit :
       {&cia402::StatusLimits::ignores, &cia402::StatusLimits::limits, &cia402::StatusLimits::lags,
        &cia402::StatusLimits::warns, &cia402::StatusLimits::no_voltage}) {
    Configuration c = puma_drives();
    c.status_limits.*limit = c.period;
    EXPECT_TRUE(check(c));
    c.status_limits.*limit -= hal::Duration(1);
    EXPECT_EQ(test::failure_of(check(c)).error, Error::kPeriodInvalid);
    EXPECT_EQ(test::failure_of(check(c)).needed, hal::seconds(c.period));
  }
}

TEST(CanopenBounds, of_what_a_drive_may_say_are_half_a_minute_to_ten_at_most) {
  using L = cia402::StatusLimits;
  struct Longest {
    hal::Duration L::* limit;
    hal::Duration time;
  };
  for (const Longest& longest :
       {Longest{&L::ignores, seconds(30)}, Longest{&L::limits, seconds(60)},
        Longest{&L::lags, seconds(30)}, Longest{&L::warns, seconds(600)},
        Longest{&L::no_voltage, seconds(30)}}) {
    Configuration c = puma_drives();
    c.status_limits.*longest.limit = longest.time;
    EXPECT_TRUE(check(c));
    c.status_limits.*longest.limit += hal::Duration(1);
    EXPECT_EQ(test::failure_of(check(c)).error, Error::kPeriodInvalid);
    EXPECT_EQ(test::failure_of(check(c)).needed, hal::seconds(longest.time));
  }
}

TEST(CanopenBounds, of_a_stop_and_of_a_drive_that_is_not_heard_are_a_minute_and_15_seconds) {
  Configuration c = puma_drives();
  c.stop_timeout = seconds(60);
  EXPECT_TRUE(check(c));
  c.stop_timeout += hal::Duration(1);
  EXPECT_EQ(test::failure_of(check(c)).needed, 60);
  c = puma_drives();
  c.heartbeat = seconds(10) + milliseconds(1);
  c.heartbeat_timeout = seconds(15);
  EXPECT_EQ(test::failure_of(check(c)).needed, 10);
  c.heartbeat = seconds(10);
  c.heartbeat_timeout += milliseconds(1);
  EXPECT_EQ(test::failure_of(check(c)).needed, 15);
  c = puma_drives();
  c.missed_feedback_limit = 7500;  // of 2 ms
  EXPECT_TRUE(check(c));
  ++c.missed_feedback_limit;
  EXPECT_EQ(test::failure_of(check(c)).needed, 15);
}

TEST(CanopenBounds, of_limits_are_ten_turns_and_twenty_metres) {
  for (const bool prismatic : {false, true}) {
    const double largest = prismatic ? 20 : 20 * kPi;
    Configuration c = puma_drives();
    if (prismatic) {
      c.axes[1].scaling.type = JointType::kPrismatic;
      c.axes[1].scaling.lead_m = 0.02;
    }
    c.axes[1].limits = {-largest, largest};
    EXPECT_TRUE(check(c));
    for (const JointLimits& limits :
         {JointLimits{-1.0001 * largest, 0}, JointLimits{0, 1.0001 * largest}}) {
      c.axes[1].limits = limits;
      EXPECT_EQ(test::failure_of(check(c)).error, Error::kLimitsImplausible);
      EXPECT_EQ(test::failure_of(check(c)).needed, largest);
    }
  }
}

TEST(CanopenBounds, of_windows_and_ramps_of_an_axis) {
  Configuration c = puma_drives();
  c.axes[2].following_window = -1e-9;
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kPeriodInvalid);
  EXPECT_EQ(test::failure_of(check(c)).needed, 0);
  EXPECT_EQ(test::failure_of(check(c)).axis, 2U);
  c.axes[2].following_window = 1e9;
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kPositionOverflow);
  c = puma_drives();
  c.axes[3].stop_deceleration = -1e-9;
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kPeriodInvalid);
  EXPECT_EQ(test::failure_of(check(c)).needed, 0);
  EXPECT_EQ(test::failure_of(check(c)).axis, 3U);
  c.axes[3].stop_deceleration = 1e9;
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kPositionOverflow);
}

TEST(CanopenBounds, a_stop_from_the_largest_speed_ends_within_its_time) {
  Configuration c = puma_drives();
  const double needed = c.axes[4].largest_speed / hal::seconds(c.stop_timeout);
  c.axes[4].stop_deceleration = needed;
  EXPECT_TRUE(check(c));
  c.axes[4].stop_deceleration = 0.999 * needed;
  const ConfigurationRefusal refusal = test::failure_of(check(c));
  EXPECT_EQ(refusal.error, Error::kPeriodInvalid);
  EXPECT_EQ(refusal.axis, 4U);
  EXPECT_EQ(refusal.found, 0.999 * needed);
  EXPECT_EQ(refusal.needed, needed);
}

TEST(CanopenBounds, of_the_masters_node_and_of_others_traffic) {
  Configuration c = puma_drives();
  c.master_node = 0;
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kNodeOutOfRange);
  EXPECT_FALSE(test::failure_of(check(c)).axis);
  c = puma_drives();
  c.master_node = 3;
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kNodeTwice);
  EXPECT_EQ(test::failure_of(check(c)).axis, 2U);
  EXPECT_EQ(test::failure_of(check(c)).needed, 0);
  c = puma_drives();
  c.others[0].traffic.push_back({8, seconds(1)});
  EXPECT_TRUE(check(c));
  c.others[0].traffic[0].data_bytes = 9;
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kPeriodInvalid);
  c.others[0].traffic[0] = {8, hal::Duration::zero()};
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kPeriodInvalid);
}

// The codes of CiA 301, table 22.
TEST(SdoAbort, has_words_of_its_own_for_each_code) {
  constexpr std::array<std::uint32_t, 28> kCodes{
      0x05030000, 0x05040000, 0x05040001, 0x05040005, 0x06010000, 0x06010001, 0x06010002,
      0x06020000, 0x06040041, 0x06040042, 0x06040043, 0x06040047, 0x06060000, 0x06070010,
      0x06070012, 0x06070013, 0x06090011, 0x06090030, 0x06090031, 0x06090032, 0x06090036,
      0x060A0023, 0x08000000, 0x08000020, 0x08000021, 0x08000022, 0x08000023, 0x08000024};
  std::set<std::string_view> words;
  for (const std::uint32_t code : kCodes) words.insert(describe_sdo_abort(code));
  EXPECT_EQ(words.size(), kCodes.size());
  EXPECT_FALSE(words.contains(describe_sdo_abort(0x12345678)));
  EXPECT_EQ(describe_sdo_abort(0x06020000), "object does not exist");
  EXPECT_EQ(describe_sdo_abort(0x06090011), "sub-index does not exist");
}

}  // namespace
}  // namespace armsig::canopen
