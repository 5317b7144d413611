// SPDX-License-Identifier: MIT
// The master and six emulated drives over the virtual bus, from power-up to every fault. The drives
// are written from the device's side of the standard, the bus has the timing of 1 Mbit/s.
#include <chrono>
#include <cmath>

#include <gtest/gtest.h>

#include "host_tests/support/emulated_arm.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_drives.hpp"
#include "host_tests/support/scripted_can_bus.hpp"

namespace armsig::canopen {
namespace {

using cia402::State;
using hal::DriveCondition;
using simulated::DriveFault;
using std::chrono::milliseconds;
using test::EmulatedArm;
using test::puma_drives;

TEST(MasterAndDrives, powers_up_with_every_drive_disabled) {
  EmulatedArm arm(puma_drives());
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  for (const auto& drive : arm.drives) EXPECT_EQ(drive.state(), State::kSwitchOnDisabled);
  arm.run(500);
  for (const auto& drive : arm.drives) EXPECT_EQ(drive.state(), State::kSwitchOnDisabled);
}

TEST(MasterAndDrives, leaves_the_objects_of_the_drives_as_the_wire_map_says) {
  EmulatedArm arm(puma_drives());
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  const simulated::DriveDictionary& objects = arm.drives[2].dictionary();
  EXPECT_EQ(objects.get(0x1400, 1), 0x203U);
  EXPECT_EQ(objects.get(0x1600, 1), 0x60400010U);
  EXPECT_EQ(objects.get(0x1600, 2), 0x607A0020U);
  EXPECT_EQ(objects.get(0x1800, 1), 0x40000183U);
  EXPECT_EQ(objects.get(0x1A00, 1), 0x60410010U);
  EXPECT_EQ(objects.get(0x1A00, 2), 0x60640020U);
  EXPECT_EQ(objects.get(0x1401, 1) >> 31, 1U);
  EXPECT_EQ(objects.get(0x60C2, 1), 2U);
  EXPECT_EQ(objects.get(0x60C2, 2), 0xFDU);
  EXPECT_EQ(objects.get(0x6061), 8U);
  EXPECT_EQ(objects.get(0x1017), 50U);
  EXPECT_EQ(objects.get(0x1016, 1), 0x007F0096U);
}

TEST(MasterAndDrives, tells_of_every_drive_who_it_is_and_how_it_is_scaled) {
  Configuration configuration = puma_drives();
  for (std::size_t i = 0; i < 6; ++i) {
    configuration.axes[i].scaling.zero_counts = static_cast<std::int32_t>(10 * i);
  }
  EmulatedArm arm(configuration);
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  for (std::size_t i = 0; i < 6; ++i) {
    const auto identity = arm.master->identity(i);
    ASSERT_TRUE(identity);
    EXPECT_EQ(identity->device[hal::kProduct], 402U);
    EXPECT_EQ(identity->zero_counts, static_cast<std::int32_t>(10 * i));
    EXPECT_EQ(identity->gear_ratio, 100);
  }
}

TEST(MasterAndDrives, turns_the_other_pdos_off_and_leaves_them_their_identifiers) {
  EmulatedArm arm(puma_drives());
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  for (std::uint32_t node = 1; node <= arm.drives.size(); ++node) {
    const simulated::DriveDictionary& objects = arm.drives[node - 1].dictionary();
    EXPECT_EQ(objects.get(0x1401, 1), 0x80000300U + node);
    EXPECT_EQ(objects.get(0x1801, 1), 0xC0000280U + node);
  }
}

TEST(MasterAndDrives, sets_every_ramp_to_rest_and_no_offset) {
  Configuration configuration = puma_drives(1);
  configuration.axes[0].stop_deceleration = kPi;
  EmulatedArm arm(configuration);
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  const simulated::DriveDictionary& objects = arm.drives[0].dictionary();
  EXPECT_EQ(objects.get(0x605A), 6U);
  EXPECT_EQ(objects.get(0x605B), 1U);
  EXPECT_EQ(objects.get(0x605C), 1U);
  EXPECT_EQ(objects.get(0x605E), 2U);
  EXPECT_EQ(objects.get(0x6085), 200000U);  // half a turn a second squared
  EXPECT_EQ(objects.get(0x60B0), 0U);
}

TEST(MasterAndDrives, a_drive_that_turns_the_sense_itself_is_refused) {
  EmulatedArm arm(puma_drives(1));
  arm.drives[0].set_object(0x607E, 0, 0x80);
  arm.run(200);
  EXPECT_EQ(arm.master->status(0).fault, Error::kSdoUnexpectedValue);
  EXPECT_EQ(arm.master->status(0).fault_code, 0x80U);
}

TEST(MasterAndDrives, enabling_does_not_move_a_joint) {
  EmulatedArm arm(puma_drives());
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.run(200);
  for (const auto& drive : arm.drives) EXPECT_EQ(drive.position(), 0);
}

TEST(MasterAndDrives, every_joint_follows_a_sine_within_a_milliradian_of_its_delay) {
  EmulatedArm arm(puma_drives());
  ASSERT_TRUE(arm.power_up_and_enable());
  const int start = arm.ticks;
  const auto wave = [](double t) { return 0.5 * (1 - std::cos(2 * t)); };
  double worst = 0;
  for (int i = 0; i < 1000; ++i) {
    arm.tick([&] {
      const double t = 0.002 * (arm.ticks - start);
      for (double& target : arm.targets) target = wave(t);
      // Sent in this tick, in force at the next SYNC, reached a period later, read in the tick
      // after that.
      for (const double actual : arm.master->positions()) {
        worst = std::fmax(worst, std::fabs(actual - wave(t - 3 * 0.002)));
      }
    });
    ASSERT_TRUE(arm.written);
  }
  EXPECT_LT(worst, 1e-3);
  EXPECT_TRUE(arm.master->all(DriveCondition::kEnabled));
}

TEST(MasterAndDrives, the_bus_carries_what_was_computed) {
  EmulatedArm arm(puma_drives());
  ASSERT_TRUE(arm.power_up_and_enable());
  const hal::Duration before = arm.bus.busy();
  arm.run(1000);
  const double load = hal::seconds(arm.bus.busy() - before) / 2.0;
  EXPECT_LT(load, check(puma_drives())->bus_load());
  EXPECT_GT(load, 0.6);
}

TEST(MasterAndDrives, disables_on_a_ramp) {
  EmulatedArm arm(puma_drives());
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.master->disable();
  arm.following = false;
  EXPECT_TRUE(arm.run_until(DriveCondition::kDisabled, 50));
}

// From the tick after the fault, every drive must be in quick stop, or without torque, within three
// ticks; the faulted joint must be named.
void expect_stopped(EmulatedArm& arm, std::size_t joint, Error error, unsigned detection_ticks) {
  unsigned ticks = 0;
  while (arm.master->status(joint).condition != DriveCondition::kFaulted && ticks < 1000) {
    arm.tick();
    ++ticks;
  }
  EXPECT_LE(ticks, detection_ticks);
  EXPECT_EQ(arm.master->status(joint).fault, error) << describe(*arm.master->status(joint).fault);
  arm.run(3);
  for (std::size_t i = 0; i < arm.drives.size(); ++i) {
    if (i == joint) continue;
    EXPECT_EQ(arm.drives[i].state(), State::kQuickStopActive) << i;
  }
  EXPECT_NE(arm.drives[joint].state(), State::kOperationEnabled);
}

struct MovingArm : EmulatedArm {
  explicit MovingArm(const Configuration& configuration = puma_drives())
      : EmulatedArm(configuration) {
    EXPECT_TRUE(power_up_and_enable());
    for (int i = 0; i < 300; ++i) {
      tick([&] {
        for (double& target : targets) target += 0.001;  // 0.5 rad/s
      });
    }
    EXPECT_TRUE(master->all(DriveCondition::kEnabled));
  }
};

TEST(MasterAndDrives, an_emergency_of_one_stops_all_within_three_ticks) {
  MovingArm arm;
  arm.drives[3].inject(DriveFault::kEmergency, 0x2310);
  expect_stopped(arm, 3, Error::kDriveEmergency, 2);
  EXPECT_EQ(arm.master->status(3).fault_code, 0x2310U);
}

TEST(MasterAndDrives, positions_lost_by_one_stop_all) {
  MovingArm arm;
  arm.drives[5].inject(DriveFault::kFeedbackLost);
  arm.run(4);
  EXPECT_EQ(arm.master->status(5).fault, Error::kFeedbackLost);
  arm.run(3);
  for (const auto& drive : arm.drives) EXPECT_EQ(drive.state(), State::kQuickStopActive);
}

TEST(MasterAndDrives, a_heartbeat_lost_stops_all) {
  MovingArm arm;
  arm.drives[1].inject(DriveFault::kHeartbeatLost);
  expect_stopped(arm, 1, Error::kHeartbeatLost, 76 + 25);
}

TEST(MasterAndDrives, a_blocked_motor_ends_in_a_following_error) {
  Configuration configuration = puma_drives();
  for (auto& axis : configuration.axes) axis.following_window = 0.05;
  MovingArm arm(configuration);
  arm.drives[0].inject(DriveFault::kBlocked);
  for (int i = 0; i < 100 && !arm.master->status(0).fault; ++i) {
    arm.tick([&] {
      for (double& target : arm.targets) target += 0.001;
    });
  }
  EXPECT_EQ(arm.master->status(0).fault, Error::kDriveEmergency);
  EXPECT_EQ(arm.master->status(0).fault_code, 0x8611U);
  arm.run(3);
  for (std::size_t i = 1; i < 6; ++i) EXPECT_EQ(arm.drives[i].state(), State::kQuickStopActive);
}

TEST(MasterAndDrives, a_drive_switched_off_from_outside_stops_all) {
  MovingArm arm;
  arm.drives[4].inject(DriveFault::kPowerRemoved);
  expect_stopped(arm, 4, Error::kDriveDroppedOut, 3);
}

TEST(MasterAndDrives, a_drive_that_restarts_stops_all) {
  MovingArm arm;
  arm.drives[4].inject(DriveFault::kReboot);
  arm.run(10);
  EXPECT_TRUE(arm.master->status(4).fault);
  EXPECT_EQ(arm.drives[0].state(), State::kQuickStopActive);
}

TEST(MasterAndDrives, a_drive_that_leaves_operational_stops_all) {
  MovingArm arm;
  arm.drives[2].inject(DriveFault::kPreOperational);
  arm.run(10);
  EXPECT_TRUE(arm.master->status(2).fault);
  EXPECT_EQ(arm.drives[0].state(), State::kQuickStopActive);
}

TEST(MasterAndDrives, a_position_that_jumps_stops_all) {
  MovingArm arm;
  arm.drives[2].inject(DriveFault::kPositionJump, 100000);
  arm.run(3);
  EXPECT_EQ(arm.master->status(2).fault, Error::kFeedbackImplausible);
}

TEST(MasterAndDrives, a_drive_deaf_to_its_controlword_is_a_fault) {
  EmulatedArm arm(puma_drives());
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  arm.drives[1].inject(DriveFault::kDeaf);
  ASSERT_TRUE(arm.master->enable());
  arm.run(510);
  EXPECT_EQ(arm.master->status(1).fault, Error::kTransitionTimeout);
  EXPECT_EQ(arm.drives[0].state(), State::kQuickStopActive);
}

// The master's process has died: the drives stop by themselves.
TEST(MasterAndDrives, drives_without_a_master_stop_by_themselves) {
  MovingArm arm;
  arm.clock.wait_until(arm.clock.now() + milliseconds(400));
  for (const auto& drive : arm.drives) EXPECT_NE(drive.state(), State::kOperationEnabled);
}

TEST(MasterAndDrives, drives_without_sync_go_to_fault_with_its_emergency) {
  MovingArm arm;
  arm.clock.wait_until(arm.clock.now() + milliseconds(12));
  for (const auto& drive : arm.drives) {
    EXPECT_EQ(drive.state(), State::kFaultReactionActive);
    EXPECT_EQ(drive.dictionary().get(0x603F), 0x8700U);
  }
}

TEST(MasterAndDrives, bus_off_stops_all_and_can_be_reset) {
  MovingArm arm;
  arm.master_port.go_bus_off();
  arm.tick();
  EXPECT_EQ(test::failure_of(arm.read), Error::kBusOff);
  arm.run(100);
  EXPECT_TRUE(arm.read);
  for (const auto& drive : arm.drives) EXPECT_NE(drive.state(), State::kOperationEnabled);
  EXPECT_EQ(arm.master->status(0).fault, Error::kBusOff);
  arm.following = false;
  arm.master->reset_faults();
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled, 3000));
  EXPECT_TRUE(arm.power_up_and_enable());
}

TEST(MasterAndDrives, the_interface_taken_down_and_up_can_be_reset) {
  MovingArm arm;
  arm.master_port.set_up(false);
  arm.run(50);
  EXPECT_EQ(test::failure_of(arm.read), Error::kBusDown);
  arm.master_port.set_up(true);
  arm.run(10);
  EXPECT_EQ(arm.master->status(0).fault, Error::kBusDown);
  arm.following = false;
  arm.master->reset_faults();
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled, 3000));
  EXPECT_TRUE(arm.power_up_and_enable());
}

// Another master's reset leaves the drives without what they were told: they are told it again.
TEST(MasterAndDrives, drives_that_another_master_has_reset_are_set_up_anew) {
  EmulatedArm arm(puma_drives());
  ASSERT_TRUE(arm.power_up_and_enable());
  simulated::VirtualCanPort stranger;
  arm.bus.connect(stranger);
  ASSERT_TRUE(stranger.send(nmt_frame(NmtCommand::kResetNode, 0)));
  arm.run(50);
  EXPECT_EQ(arm.master->status(0).fault, Error::kSecondMaster);
  arm.following = false;
  arm.master->reset_faults();
  EXPECT_TRUE(arm.power_up_and_enable());
}

TEST(MasterAndDrives, every_fault_can_be_reset_and_the_arm_enabled_again) {
  for (const DriveFault fault :
       {DriveFault::kEmergency, DriveFault::kSilent, DriveFault::kHeartbeatLost,
        DriveFault::kFeedbackLost, DriveFault::kPowerRemoved, DriveFault::kReboot,
        DriveFault::kPositionJump, DriveFault::kPreOperational}) {
    MovingArm arm;
    arm.drives[3].inject(fault, 0x1000);
    arm.run(200);
    EXPECT_EQ(arm.master->status(3).condition, DriveCondition::kFaulted) << static_cast<int>(fault);
    arm.drives[3].inject(DriveFault::kNone);
    arm.following = false;
    arm.master->reset_faults();
    ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled, 3000)) << static_cast<int>(fault);
    EXPECT_TRUE(arm.power_up_and_enable()) << static_cast<int>(fault);
  }
}

TEST(MasterAndDrives, a_drive_that_never_answers_is_named_and_the_others_are_set_up) {
  EmulatedArm arm(puma_drives());
  arm.drives[2].inject(DriveFault::kSdoSilent);
  arm.run(1500);
  EXPECT_EQ(arm.master->status(2).fault, Error::kSdoTimeout);
  EXPECT_EQ(arm.master->status(5).condition, DriveCondition::kDisabled);
}

TEST(MasterAndDrives, any_frame_injected_leaves_the_arm_stopped_or_going_on_but_never_enables_it) {
  for (std::uint32_t id = 0; id < 0x800; ++id) {
    EmulatedArm arm(puma_drives(2));
    simulated::VirtualCanPort intruder;
    arm.bus.connect(intruder);
    ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
    const hal::CanFrame frame{.id = id, .length = 8, .data = {0x0F, 0, 0xFF, 0xFF, 0xFF, 0xFF}};
    ASSERT_TRUE(intruder.send(frame));
    arm.run(20);
    for (const auto& drive : arm.drives) {
      ASSERT_NE(drive.state(), State::kOperationEnabled) << std::hex << id;
      ASSERT_EQ(drive.velocity(), 0) << std::hex << id;
    }
  }
}

}  // namespace
}  // namespace armsig::canopen
