// SPDX-License-Identifier: MIT
// What the servo tick faults for and what not.
#include <gtest/gtest.h>

#include "host_tests/support/servo_bench.hpp"

namespace armsig::controller {
namespace {

using Bench = ServoBench;
using enum hal::DriveCondition;

TEST(ServoFaults, following_error_is_judged_at_each_joint_by_its_own_bound_either_way) {
  for (std::size_t joint = 0; joint < 6; ++joint) {
    for (const double way : {-1.0, 1.0}) {
      Bench bench;
      bench.configuration.supervision.following_error[joint] = 0.02;
      ASSERT_NO_FATAL_FAILURE(bench.hold());
      bench.drives.actual[joint] += way * 0.0199;
      EXPECT_EQ(bench.tick().mode, Mode::kHolding);
      bench.drives.actual[joint] += way * 0.0002;
      bench.tick();
      bench.expect_fault(Error::kFollowingError, joint);
    }
  }
}

TEST(ServoFaults, a_position_that_is_no_number_is_a_following_error) {
  Bench bench;
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  bench.drives.actual[4] = std::numeric_limits<double>::quiet_NaN();
  bench.tick();
  bench.expect_fault(Error::kFollowingError, 4);
}

TEST(ServoFaults, following_counts_only_with_torque) {
  Bench bench;
  bench.tick();
  bench.drives.actual[2] += 1;
  EXPECT_EQ(bench.tick().mode, Mode::kIdle);
  EXPECT_EQ(bench.tick().commanded[2], bench.drives.actual[2]) << "a shaft that is turned by hand";
}

TEST(ServoFaults, of_a_drive_are_told_with_its_code_and_words_in_every_mode) {
  Bench bench;
  bench.tick();
  bench.drives.statuses[3].fault = Error::kDriveFault;
  bench.drives.statuses[3].fault_code = 0x4210;
  bench.drives.statuses[3].words = "too warm";
  bench.drives.statuses[3].fault_object = {.index = 0x605A, .subindex = 0, .found = 0, .wanted = 6};
  bench.tick();
  bench.expect_fault(Error::kDriveFault, 3);
  EXPECT_EQ(bench.link.snapshot.read().fault->code, 0x4210U);
  EXPECT_EQ(bench.link.snapshot.read().fault->words, "too warm");
  EXPECT_EQ(bench.link.snapshot.read().fault->object.index, 0x605A);
}

TEST(ServoFaults, a_drive_that_says_why_later_is_listened_to_and_another_cause_is_not) {
  Bench bench;
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  bench.drives.statuses[1].condition = kFaulted;
  bench.tick();
  bench.expect_fault(Error::kDriveFault, 1);
  EXPECT_EQ(bench.link.snapshot.read().fault->code, 0U);
  bench.drives.statuses[1].fault = Error::kHeartbeatLost;
  bench.drives.statuses[1].fault_code = 7;
  EXPECT_EQ(bench.tick().fault->code, 0U) << "of another cause";
  bench.drives.statuses[1].fault = Error::kDriveFault;
  bench.drives.statuses[1].fault_code = 0x2310;
  bench.drives.statuses[1].words = "current";
  EXPECT_EQ(bench.tick().fault->code, 0x2310U);
  EXPECT_EQ(bench.link.snapshot.read().fault->words, "current");
  bench.drives.statuses[1].fault_code = 0x9999;
  EXPECT_EQ(bench.tick().fault->code, 0x2310U) << "the first is kept";
}

TEST(ServoFaults, an_interface_that_fails_at_a_write_is_named_in_the_same_tick) {
  Bench bench;
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  bench.drives.on_write = Error::kBusDown;
  bench.drives.faults_on_write = 3;
  bench.drives.statuses[3].words = "can2";
  bench.tick();
  bench.expect_fault(Error::kBusDown, 3);
  EXPECT_EQ(bench.link.snapshot.read().fault->words, "can2");
}

TEST(ServoFaults, the_first_cause_is_kept) {
  Bench bench;
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  bench.drives.statuses[2].fault = Error::kDriveFault;
  bench.drives.statuses[5].fault = Error::kHeartbeatLost;
  bench.drives.on_read = Error::kBusOff;
  bench.tick();
  bench.expect_fault(Error::kDriveFault, 2);
  bench.tick();
  EXPECT_EQ(bench.drives.quick_stops, 1);
}

TEST(ServoFaults, a_drive_that_leaves_its_state_by_itself_is_one_only_while_the_arm_has_torque) {
  Bench bench;
  bench.drives.statuses[4].status_word = 0x1234;
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  bench.drives.statuses[4].condition = kSwitching;
  bench.tick();
  bench.expect_fault(Error::kDriveDroppedOut, 4);
  EXPECT_EQ(bench.link.snapshot.read().fault->code, 0x1234U);
}

TEST(ServoFaults, a_bus_that_cant_be_read_is_one) {
  Bench bench;
  bench.tick();
  bench.drives.on_read = Error::kBusOff;
  bench.tick();
  bench.expect_fault(Error::kBusOff, std::nullopt);
}

TEST(ServoFaults, a_target_that_the_drives_refuse_is_one_with_torque_and_a_full_queue_is_none) {
  Bench bench;
  bench.drives.on_write = Error::kTargetStep;
  bench.tick();
  EXPECT_EQ(bench.tick().mode, Mode::kIdle);
  bench.drives.on_write.reset();
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  bench.drives.on_write = Error::kBusBusy;
  EXPECT_EQ(bench.tick().mode, Mode::kHolding);
  bench.drives.on_write = Error::kTargetStep;
  bench.tick();
  bench.expect_fault(Error::kTargetStep, std::nullopt);
}

TEST(ServoFaults, are_left_by_reset_alone) {
  Bench bench;
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  EXPECT_EQ(bench.send(CommandKind::kReset), Error::kWrongMode);
  EXPECT_EQ(bench.send(CommandKind::kStop), std::nullopt);
  bench.expect_fault(Error::kQuickStop, std::nullopt);
  for (const CommandKind kind : {CommandKind::kEnable, CommandKind::kDisable, CommandKind::kHalt,
                                 CommandKind::kMove, CommandKind::kBeginSequence}) {
    EXPECT_EQ(bench.send(kind), Error::kWrongMode) << static_cast<int>(kind);
  }
  EXPECT_EQ(bench.drives.disabled, 0);
  bench.drives.set_all(kStopped);
  EXPECT_EQ(bench.send(CommandKind::kReset), std::nullopt);
  EXPECT_EQ(bench.drives.resets, 1);
  EXPECT_EQ(bench.tick().mode, Mode::kStarting);
  EXPECT_FALSE(bench.link.snapshot.read().fault);
  bench.drives.set_all(kDisabled);
  EXPECT_EQ(bench.tick().mode, Mode::kIdle);
}

}  // namespace
}  // namespace armsig::controller
