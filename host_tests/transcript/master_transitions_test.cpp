// SPDX-License-Identifier: MIT
// Every commanded transition of CiA 402 on the wire. Statuswords carry bit 9 (remote) and bit 4
// (voltage enabled) where a drive sets them; positions stay at 1000 counts (E8 03 00 00).
#include <chrono>

#include <gtest/gtest.h>

#include "host_tests/support/master_script.hpp"

namespace armsig::canopen {
namespace {

using hal::DriveCondition;
using test::MasterScript;

void enable(MasterScript& script) {
  ASSERT_TRUE(script.master->enable());
  script.cycle("181#5002E8030000", "201#0600E8030000");  // transition 2, shutdown
  script.cycle("181#3102E8030000", "201#0700E8030000");  // transition 3, switch on
  script.cycle("181#3302E8030000", "201#0F00E8030000");  // transition 4, enable operation
  script.cycle("181#3712E8030000", "201#0F00E8030000");  // Operation enabled, held
  ASSERT_EQ(script.master->status(0).condition, DriveCondition::kEnabled);
}

TEST(MasterTransitions, enables_by_2_3_4_and_is_switching_meanwhile) {
  MasterScript script;
  script.start();
  ASSERT_TRUE(script.master->enable());
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kSwitching);
  script.cycle("181#5002E8030000", "201#0600E8030000");
  script.cycle("181#3102E8030000", "201#0700E8030000");
  script.cycle("181#3302E8030000", "201#0F00E8030000");
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kSwitching);
  script.cycle("181#3712E8030000", "201#0F00E8030000");
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kEnabled);
  script.bus.expect_all_consumed();
}

TEST(MasterTransitions, repeats_a_command_until_the_drive_follows) {
  MasterScript script;
  script.start();
  ASSERT_TRUE(script.master->enable());
  for (int i = 0; i < 5; ++i) script.cycle("181#5002E8030000", "201#0600E8030000");
  script.bus.expect_all_consumed();
}

TEST(MasterTransitions, sends_targets_only_when_enabled) {
  MasterScript script;
  script.start();
  script.keep_targets = true;
  script.targets[0] = (1000 + 100) / 400000.0 * 2 * kPi;
  ASSERT_TRUE(script.master->enable());
  script.cycle("181#5002E8030000", "201#0600E8030000");
  script.cycle("181#3102E8030000", "201#0700E8030000");
  script.cycle("181#3302E8030000", "201#0F00E8030000");
  script.cycle("181#3712E8030000", "201#0F004C040000");  // 1100 counts
  EXPECT_TRUE(script.written);
}

TEST(MasterTransitions, disables_by_5_6_7) {
  MasterScript script;
  script.start();
  enable(script);
  script.master->disable();
  script.cycle("181#3712E8030000", "201#0700E8030000");  // transition 5, disable operation
  script.cycle("181#3712E8030000", "201#0700E8030000");  // still on its ramp
  script.cycle("181#3302E8030000", "201#0600E8030000");  // transition 6, shutdown
  script.cycle("181#3102E8030000", "201#0000E8030000");  // transition 7, disable voltage
  script.cycle("181#5002E8030000", "201#0000E8030000");
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kDisabled);
  script.bus.expect_all_consumed();
}

TEST(MasterTransitions, stops_by_11_holds_and_disables_by_12) {
  MasterScript script;
  script.start();
  enable(script);
  script.master->quick_stop();
  script.cycle("181#3712E8030000", "201#0200E8030000");  // transition 11, quick stop
  script.cycle("181#1702E8030000", "201#0200E8030000");
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kStopped);
  script.master->disable();
  script.cycle("181#1702E8030000", "201#0000E8030000");  // transition 12, disable voltage
  script.cycle("181#5002E8030000", "201#0000E8030000");
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kDisabled);
  script.bus.expect_all_consumed();
}

TEST(MasterTransitions, enables_again_after_a_quick_stop_by_12_2_3_4) {
  MasterScript script;
  script.start();
  enable(script);
  script.master->quick_stop();
  script.cycle("181#3712E8030000", "201#0200E8030000");
  script.cycle("181#1702E8030000", "201#0200E8030000");
  ASSERT_TRUE(script.master->enable());
  script.cycle("181#1702E8030000", "201#0000E8030000");
  enable(script);
  script.bus.expect_all_consumed();
}

TEST(MasterTransitions, a_quick_stop_while_switching_on_takes_10_or_7) {
  MasterScript script;
  script.start();
  ASSERT_TRUE(script.master->enable());
  script.cycle("181#5002E8030000", "201#0600E8030000");
  script.cycle("181#3102E8030000", "201#0700E8030000");
  script.master->quick_stop();
  script.cycle("181#3302E8030000", "201#0000E8030000");  // transition 10
  script.cycle("181#5002E8030000", "201#0000E8030000");
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kStopped);
  ASSERT_TRUE(script.master->enable());
  script.cycle("181#5002E8030000", "201#0600E8030000");
  script.master->quick_stop();
  script.cycle("181#3102E8030000", "201#0000E8030000");  // transition 7
  script.bus.expect_all_consumed();
}

TEST(MasterTransitions, resets_a_fault_by_15_on_a_rising_edge) {
  MasterScript script;
  script.start();
  script.cycle("181#1802E8030000", "201#0000E8030000");
  EXPECT_EQ(script.master->status(0).fault, Error::kDriveFault);
  script.master->reset_faults();
  script.cycle("181#1802E8030000", "201#8000E8030000");  // transition 15, fault reset
  script.cycle("181#1802E8030000", "201#0000E8030000");  // missed: the bit falls ...
  script.cycle("181#1802E8030000", "201#8000E8030000");  // ... and rises again
  script.cycle("181#5002E8030000", "201#0000E8030000");
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kDisabled);
  script.bus.expect_all_consumed();
}

TEST(MasterTransitions, a_fault_that_stays_comes_back_after_the_time_allowed) {
  MasterScript script;
  script.start();
  script.cycle("181#1802E8030000", "201#0000E8030000");
  script.master->reset_faults();
  script.cycle("181#1802E8030000", "201#8000E8030000");
  EXPECT_EQ(script.master->status(0).fault, std::nullopt);
  for (int i = 0; i < 1000; ++i) {
    if (i % 50 == 45) script.bus.bring("701#05");
    script.bus.expect("080#", {"181#1802E8030000"});
    if ((script.bus.now.time_since_epoch() + std::chrono::milliseconds(1)) %
            std::chrono::milliseconds(50) ==
        hal::Duration::zero()) {
      script.bus.expect("77F#05");
    }
    // Fault reset on and off, until the fault is taken for lasting.
    const bool lasting = i == 999;
    script.bus.expect(lasting || i % 2 == 0 ? "201#0000E8030000" : "201#8000E8030000");
    script.tick();
  }
  EXPECT_EQ(script.master->status(0).fault, Error::kDriveFault);
  script.bus.expect_all_consumed();
}

}  // namespace
}  // namespace armsig::canopen
