// SPDX-License-Identifier: MIT
// A drive that finds its reference by itself, without any bus: what its statusword says of it.
#include <chrono>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "hal/cia402/drive.hpp"

namespace armsig::cia402 {
namespace {

using hal::DriveCondition;
using std::chrono::milliseconds;

constexpr std::uint16_t kEnabledWord = 0x0237;
constexpr std::uint16_t kFollows = 1U << 12;
constexpr std::uint16_t kFound = 1U << 10 | 1U << 12;
constexpr std::uint16_t kGaveUp = 1U << 13;
constexpr DriveSettings kSettings{.scaling = {.counts_per_revolution = 4000, .gear_ratio = 100},
                                  .limits = {radians(-170), radians(170)},
                                  .largest_speed = 2.0};

struct HomingDrive : ::testing::Test {
  HomingDrive() {
    drive.set_goal(Goal::kEnabled, now);
    for (int i = 0; i < 100; ++i) tell(kEnabledWord | kFollows);
    EXPECT_EQ(drive.status().condition, DriveCondition::kEnabled);
    drive.begin_homing(now);
  }
  void tell(unsigned word) {
    now += milliseconds(2);
    drive.hear(static_cast<std::uint16_t>(word), counts, now);
    drive.supervise(settings, now);
    sent = drive.command(true);
  }
  void tell_for(unsigned word, hal::Duration time) {
    for (const hal::Instant end = now + time; now < end;) tell(word);
  }
  void search() {
    drive.search(now);
    tell(kEnabledWord);
  }

  GroupSettings settings;
  hal::Instant now;
  std::int32_t counts = 5000;
  Drive drive{kSettings, *Scaling::make(kSettings.scaling)};
  Setpoint sent;
};

TEST_F(HomingDrive, searches_while_bit_4_of_its_controlword_is_set) {
  tell(kEnabledWord);
  EXPECT_EQ(sent.control_word, 0x0F) << "its mode is not shown yet";
  search();
  EXPECT_EQ(sent.control_word, 0x1F);
  EXPECT_EQ(drive.status().condition, DriveCondition::kHoming);
  EXPECT_FALSE(drive.is_enabled()) << "it follows no targets";
}

TEST_F(HomingDrive, has_found_its_reference_where_bits_10_and_12_say_so_and_it_stands) {
  search();
  counts = 70000;  // by itself, faster than any joint: it counts anew
  tell(kEnabledWord | kFound);
  EXPECT_FALSE(drive.status().homed) << "it moved a moment ago";
  tell_for(kEnabledWord | kFound, milliseconds(100));
  EXPECT_TRUE(drive.status().homed);
  EXPECT_EQ(drive.state().homing, Homing::kLeaving);
  EXPECT_EQ(sent.control_word, 0x0F);
  EXPECT_FALSE(drive.status().fault);
  EXPECT_EQ(sent.target_counts, 70000) << "where it is, for the mode that follows";
}

TEST_F(HomingDrive, takes_no_answer_about_a_search_before) {
  drive.search(now);
  tell_for(kEnabledWord | kFound, milliseconds(190));
  EXPECT_FALSE(drive.status().homed);
  tell_for(kEnabledWord | kFound, milliseconds(20));
  EXPECT_TRUE(drive.status().homed) << "a method that takes the place where it stands";
}

TEST_F(HomingDrive, half_of_an_answer_is_none) {
  search();
  tell_for(kEnabledWord | 1U << 12, milliseconds(500));
  tell_for(kEnabledWord | 1U << 10, milliseconds(500));
  EXPECT_FALSE(drive.status().homed);
  EXPECT_EQ(drive.state().homing, Homing::kSearching);
}

TEST_F(HomingDrive, that_gives_up_is_faulted) {
  search();
  tell_for(kEnabledWord | kGaveUp, milliseconds(190));
  EXPECT_FALSE(drive.status().fault) << "bit 13 may be about the time before";
  tell_for(kEnabledWord | kGaveUp, milliseconds(20));
  EXPECT_EQ(drive.status().fault, Error::kHomingFailed);
  EXPECT_EQ(drive.status().fault_code, kEnabledWord | kGaveUp);
  EXPECT_FALSE(drive.status().homed);
}

TEST_F(HomingDrive, that_searches_for_too_long_is_faulted) {
  settings.homing_timeout = milliseconds(600);
  search();
  tell_for(kEnabledWord, milliseconds(590));
  EXPECT_FALSE(drive.status().fault);
  tell_for(kEnabledWord, milliseconds(20));
  EXPECT_EQ(drive.status().fault, Error::kHomingFailed);
}

TEST_F(HomingDrive, any_other_goal_ends_the_search) {
  for (const Goal goal : {Goal::kStopped, Goal::kDisabled}) {
    search();
    drive.set_goal(goal, now);
    EXPECT_EQ(drive.state().homing, Homing::kLeaving);
    EXPECT_EQ(drive.status().condition, DriveCondition::kSwitching);
    tell(kEnabledWord);
    EXPECT_EQ(sent.control_word & kControlHomingStart, 0);
    drive.set_goal(Goal::kEnabled, now);
    drive.end_homing(now);
    drive.begin_homing(now);
  }
}

TEST_F(HomingDrive, that_drops_out_while_it_searches_is_faulted) {
  search();
  tell(0x0250);
  EXPECT_EQ(drive.status().fault, Error::kDriveDroppedOut);
}

TEST_F(HomingDrive, follows_targets_again_once_its_mode_is_seen) {
  search();
  tell_for(kEnabledWord | kFound, milliseconds(100));
  drive.end_homing(now);
  tell(kEnabledWord | kFollows);
  EXPECT_TRUE(drive.awaits_mode());
  EXPECT_EQ(drive.status().condition, DriveCondition::kSwitching);
  drive.show_mode();
  tell(kEnabledWord | kFollows);
  EXPECT_EQ(drive.status().condition, DriveCondition::kEnabled);
  EXPECT_TRUE(drive.status().homed);
}

TEST_F(HomingDrive, that_is_set_up_anew_has_not_homed) {
  search();
  tell_for(kEnabledWord | kFound, milliseconds(100));
  drive.forget();
  EXPECT_FALSE(drive.status().homed);
  EXPECT_EQ(drive.state().homing, Homing::kNone);
}

}  // namespace
}  // namespace armsig::cia402
