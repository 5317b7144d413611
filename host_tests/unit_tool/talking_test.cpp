// SPDX-License-Identifier: MIT
// When a sequence has ended and how, by what the controller says.
#include "firmware/host_tool/console/talking.hpp"

#include <gtest/gtest.h>

namespace armsig::tool {
namespace {

constexpr const char* kResting = "ok mode=holding moving=no sensor=well sequence=none ticks=9";
constexpr const char* kIdentifying = "ok mode=sweeping moving=yes sequence=identifying points=3";
constexpr const char* kPaused = "ok mode=sweeping moving=no sequence=paused points=3";
constexpr const char* kFaulted = "ok mode=faulted fault=QUICK_STOP moving=no sequence=none";

TEST(Ending, is_not_yet_while_anything_is_under_way) {
  const Ending ending;
  EXPECT_EQ(ending.told(kIdentifying), "");
  EXPECT_EQ(ending.told("ok mode=servoing moving=yes sequence=none"), "");
  EXPECT_EQ(ending.told("ok mode=starting moving=no sequence=none"), "");
  EXPECT_EQ(ending.told("ok mode=sweeping moving=no sequence=checking points=1"), "");
}

TEST(Ending, is_well_where_nothing_is_under_way) {
  EXPECT_EQ(Ending().told(kResting), "ok nothing is under way");
}

TEST(Ending, is_told_by_the_line_that_said_it) {
  Ending ending;
  ending.hear("# identify swept joint=6");
  ending.hear("# identify done");
  EXPECT_EQ(ending.told(kIdentifying), "");
  EXPECT_EQ(ending.told(kResting), "ok identify done");
}

TEST(Ending, is_bad_where_the_sequence_was_given_up) {
  Ending ending;
  ending.hear("# identify ended error=NOT_SETTLED reason=\"off its target\" joint=3");
  EXPECT_EQ(ending.told(kResting),
            "error identify ended error=NOT_SETTLED reason=\"off its target\" joint=3");
}

TEST(Ending, of_a_check_is_its_verdict) {
  Ending well;
  well.hear("# check verdict=\"as accepted\" dx_mm=0.01");
  well.hear("# the arm is as it was accepted");
  EXPECT_EQ(well.told(kResting), "ok check verdict=\"as accepted\" dx_mm=0.01");
  Ending badly;
  badly.hear("# check verdict=\"drifting\" dx_mm=0.31");
  EXPECT_EQ(badly.told(kResting), "error check verdict=\"drifting\" dx_mm=0.31");
}

TEST(Ending, by_a_fault_names_the_fault_and_not_what_it_ended) {
  Ending ending;
  ending.hear("# mode faulted error=DRIVE_EMERGENCY joint=4");
  ending.hear("# identify ended error=DRIVE_EMERGENCY");
  EXPECT_EQ(ending.told(kFaulted), "error mode faulted error=DRIVE_EMERGENCY joint=4");
}

TEST(Ending, is_bad_where_it_was_faulted_before_anybody_listened) {
  EXPECT_TRUE(Ending().told(kFaulted).starts_with("error the controller is faulted"));
}

TEST(Ending, waits_for_nobody_who_has_to_resume) {
  Ending ending;
  EXPECT_TRUE(ending.told(kPaused).starts_with("error the sequence is paused"));
  ending.hear("# identify paused error=SENSOR_SILENT go on with resume");
  EXPECT_EQ(ending.told(kPaused), "error identify paused error=SENSOR_SILENT go on with resume");
  ending.hear("# identify done");  // somebody else has resumed
  EXPECT_EQ(ending.told(kResting), "ok identify done");
}

TEST(Ending, of_enable_is_torque_and_of_disable_that_it_has_gone) {
  constexpr const char* kIdle = "ok mode=idle moving=no sequence=none";
  Ending enabling;
  enabling.begun("enable");
  EXPECT_EQ(enabling.told(kIdle), "");
  EXPECT_EQ(enabling.told(kResting), "ok nothing is under way");
  enabling.hear("# mode faulted error=TARGETS_IGNORED joint=2");
  EXPECT_EQ(enabling.told(kFaulted), "error mode faulted error=TARGETS_IGNORED joint=2");
  Ending disabling;
  disabling.begun("disable");
  EXPECT_EQ(disabling.told(kResting), "");
  EXPECT_EQ(disabling.told(kIdle), "ok nothing is under way");
}

TEST(Ending, of_home_is_the_reference_found) {
  constexpr const char* kHoming = "ok mode=homing moving=no sequence=none";
  Ending homing;
  homing.begun("home");
  EXPECT_EQ(homing.told(kHoming), "");
  EXPECT_EQ(homing.told(kResting), "error the search has ended without a reference");
  homing.hear("# mode faulted error=HOMING_FAILED joint=2");
  EXPECT_EQ(homing.told(kFaulted), "error mode faulted error=HOMING_FAILED joint=2");
  Ending found;
  found.begun("home");
  found.hear("# homed joint=2");
  EXPECT_EQ(found.told(kHoming), "");
  EXPECT_EQ(found.told(kResting), "ok homed joint=2");
}

TEST(Ending, of_reset_is_no_fault_of_before) {
  Ending ending;
  ending.begun("reset");
  EXPECT_EQ(ending.told(kFaulted), "");
  EXPECT_EQ(ending.told("ok mode=idle moving=no sequence=none"), "ok nothing is under way");
  ending.hear("# mode faulted error=BOOT_TIMEOUT");
  EXPECT_EQ(ending.told(kFaulted), "error mode faulted error=BOOT_TIMEOUT");
}

TEST(Ending, forgets_what_an_earlier_request_came_to) {
  Ending ending;
  ending.hear("# identify ended error=HALTED");
  ending.forget();
  EXPECT_EQ(ending.told(kResting), "ok nothing is under way");
}

TEST(Ending, takes_no_word_of_what_it_does_not_know) {
  Ending ending;
  ending.hear("identify ended");
  ending.hear("# touched vertex=3");
  EXPECT_EQ(ending.told("ok mode=holding moving=no sequence=nonesuch"), "");
  EXPECT_EQ(ending.told(kResting), "ok nothing is under way");
}

}  // namespace
}  // namespace armsig::tool
