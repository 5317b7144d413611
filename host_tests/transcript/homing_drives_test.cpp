// SPDX-License-Identifier: MIT
// The master and emulated drives that count from zero at every power-up, until they have homed.
#include <cmath>

#include <gtest/gtest.h>

#include "host_tests/support/emulated_arm.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_drives.hpp"

namespace armsig::canopen {
namespace {

using hal::DriveCondition;
using simulated::DriveFault;

constexpr double kStart = 30000;
constexpr double kSwitch = 32000;
constexpr std::uint32_t kSwitchReads = 32000;  // 607Ch
constexpr double kCountsPerRadian = 400000 / (2 * kPi);

simulated::DriveConfiguration counting_anew() {
  simulated::DriveConfiguration drive;
  drive.motion.start = kStart;
  drive.counts_anew = true;
  drive.home_switch = kSwitch;
  return drive;
}

Configuration homing_drives() {
  Configuration configuration = test::puma_drives(3);
  configuration.axes[1].homing_method = 17;
  return configuration;
}

struct HomingArm : test::EmulatedArm {
  explicit HomingArm(const Configuration& configuration = homing_drives(),
                     const simulated::DriveConfiguration& drive = counting_anew())
      : EmulatedArm(configuration, nullptr, drive) {
    drives[1].set_object(0x607C, 0, kSwitchReads);
  }
  [[nodiscard]] DriveCondition condition() const { return master->status(1).condition; }
  bool run_while_homing(unsigned most = 5000) {
    for (unsigned i = 0; i < most && condition() == DriveCondition::kHoming; ++i) {
      tick([&] { targets[1] = master->positions()[1]; });
    }
    return condition() != DriveCondition::kHoming;
  }
};

TEST(HomingDrives, count_from_zero_after_a_power_up_and_from_their_reference_once_homed) {
  HomingArm arm;
  ASSERT_TRUE(arm.power_up_and_enable());
  EXPECT_NEAR(arm.master->positions()[1], 0, 1e-4);
  const JointVector before = arm.master->positions();
  ASSERT_TRUE(arm.master->home(1));
  arm.run(1);
  EXPECT_EQ(arm.condition(), DriveCondition::kHoming);
  ASSERT_TRUE(arm.run_while_homing());
  ASSERT_TRUE(arm.run_until(DriveCondition::kEnabled));
  EXPECT_TRUE(arm.master->status(1).homed);
  EXPECT_FALSE(arm.master->status(0).homed);
  EXPECT_NEAR(arm.master->positions()[1] * kCountsPerRadian, arm.drives[1].position(), 1);
  EXPECT_EQ(arm.drives[1].dictionary().get(0x6060), 8U);
  EXPECT_EQ(arm.drives[1].dictionary().get(0x6098), 17U);
  for (const std::size_t other : {0U, 2U}) {
    EXPECT_NEAR(arm.master->positions()[other], before[other], 1e-4);
  }
}

TEST(HomingDrives, follow_targets_from_where_they_are_then) {
  HomingArm arm;
  ASSERT_TRUE(arm.power_up_and_enable() && arm.master->home(1));
  ASSERT_TRUE(arm.run_while_homing() && arm.run_until(DriveCondition::kEnabled));
  arm.targets[1] = arm.master->positions()[1];
  const double from = arm.targets[1];
  for (int i = 0; i < 500; ++i) arm.tick([&] { arm.targets[1] -= 1e-4; });
  arm.run(200);
  ASSERT_TRUE(arm.written);
  EXPECT_NEAR(arm.master->positions()[1], from - 0.05, 1e-4);
  EXPECT_NEAR(arm.drives[1].position(), kCountsPerRadian * (from - 0.05), 5);
}

// Each of the two axes, by its own objects, while the other one holds.
TEST(HomingDrives, that_are_an_axis_of_a_node_home_and_the_other_axis_holds) {
  for (const std::size_t homing : {0U, 1U}) {
    const std::size_t other = 1 - homing;
    Configuration configuration = homing_drives();
    configuration.axes[1].node = configuration.axes[0].node;
    configuration.axes[1].axis = 2;
    configuration.axes[0].homing_method = 17;
    HomingArm arm(configuration);
    arm.drives[0].set_object(0x607C, 0, kSwitchReads);
    ASSERT_TRUE(arm.power_up_and_enable());
    const double held = arm.master->positions()[other];
    ASSERT_TRUE(arm.master->home(homing));
    for (int i = 0; i < 5000 && !arm.master->status(homing).homed; ++i) {
      arm.tick([&] { arm.targets[homing] = arm.master->positions()[homing]; });
      ASSERT_NEAR(arm.master->positions()[other], held, 1e-4);
      ASSERT_EQ(arm.drives[other].dictionary().get(0x6060), 8U);
    }
    EXPECT_TRUE(arm.master->status(homing).homed);
    EXPECT_FALSE(arm.master->status(other).homed);
    arm.targets[homing] = arm.master->positions()[homing];
    ASSERT_TRUE(arm.run_until(DriveCondition::kEnabled));
    EXPECT_NEAR(arm.master->positions()[homing] * kCountsPerRadian, arm.drives[homing].position(),
                1);
    EXPECT_EQ(arm.drives[homing].dictionary().get(0x6060), 8U);
  }
}

TEST(HomingDrives, are_not_homed_unless_all_are_enabled) {
  HomingArm arm;
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  EXPECT_EQ(test::failure_of(arm.master->home(1)), Error::kDrivesNotReady);
  ASSERT_TRUE(arm.power_up_and_enable() && arm.master->home(1));
  arm.run(5);
  EXPECT_EQ(test::failure_of(arm.master->home(0)), Error::kDrivesNotReady) << "one at a time";
}

TEST(HomingDrives, without_a_switch_are_faulted_and_set_up_again_by_a_reset) {
  auto drive = counting_anew();
  drive.home_switch.reset();
  HomingArm arm(homing_drives(), drive);
  ASSERT_TRUE(arm.power_up_and_enable() && arm.master->home(1));
  ASSERT_TRUE(arm.run_while_homing());
  EXPECT_EQ(arm.master->status(1).fault, Error::kHomingFailed);
  EXPECT_FALSE(arm.master->status(1).homed);
  arm.following = false;
  arm.run(1000);
  arm.master->reset_faults();
  ASSERT_TRUE(arm.power_up_and_enable());
  EXPECT_EQ(arm.drives[1].dictionary().get(0x6060), 8U);
}

TEST(HomingDrives, that_are_blocked_are_faulted_when_the_time_is_over) {
  Configuration configuration = homing_drives();
  configuration.homing_timeout = std::chrono::seconds(2);
  HomingArm arm(configuration);
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.drives[1].inject(DriveFault::kBlocked);
  ASSERT_TRUE(arm.master->home(1));
  ASSERT_TRUE(arm.run_while_homing(1100));
  EXPECT_EQ(arm.master->status(1).fault, Error::kHomingFailed);
}

TEST(HomingDrives, that_have_no_such_mode_are_refused_by_the_object) {
  HomingArm arm;
  arm.drives[1].set_object(0x6502, 0, 0x80);
  ASSERT_TRUE(arm.power_up_and_enable() && arm.master->home(1));
  ASSERT_TRUE(arm.run_while_homing());
  const hal::DriveStatus status = arm.master->status(1);
  EXPECT_EQ(status.fault, Error::kSdoAborted);
  EXPECT_EQ(status.fault_object.index, 0x6060);
}

TEST(HomingDrives, that_do_not_answer_are_faulted) {
  HomingArm arm;
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.drives[1].inject(DriveFault::kSdoSilent);
  ASSERT_TRUE(arm.master->home(1));
  ASSERT_TRUE(arm.run_while_homing());
  EXPECT_EQ(arm.master->status(1).fault, Error::kSdoTimeout);
}

TEST(HomingDrives, stop_where_they_are_told_to_and_keep_their_torque) {
  HomingArm arm;
  ASSERT_TRUE(arm.power_up_and_enable() && arm.master->home(1));
  for (int i = 0; i < 300; ++i) arm.tick([&] { arm.targets[1] = arm.master->positions()[1]; });
  EXPECT_GT(arm.drives[1].position(), kStart + 100) << "on its way";
  arm.master->stop_homing();
  ASSERT_TRUE(arm.run_while_homing());
  ASSERT_TRUE(arm.run_until(DriveCondition::kEnabled));
  const double stopped = arm.drives[1].position();
  EXPECT_LT(stopped, kSwitch - 100);
  EXPECT_FALSE(arm.master->status(1).homed);
  arm.run(500);
  EXPECT_NEAR(arm.drives[1].position(), stopped, 1);
}

TEST(HomingDrives, that_are_disabled_on_the_way_can_be_enabled_again) {
  HomingArm arm;
  ASSERT_TRUE(arm.power_up_and_enable() && arm.master->home(1));
  for (int i = 0; i < 300; ++i) arm.tick([&] { arm.targets[1] = arm.master->positions()[1]; });
  arm.master->disable();
  arm.following = false;
  ASSERT_TRUE(arm.power_up_and_enable());
  EXPECT_EQ(arm.drives[1].dictionary().get(0x6060), 8U);
  EXPECT_FALSE(arm.master->status(1).homed);
}

TEST(HomingDrives, that_reboot_on_the_way_are_set_up_by_a_reset) {
  HomingArm arm;
  ASSERT_TRUE(arm.power_up_and_enable() && arm.master->home(1));
  for (int i = 0; i < 300; ++i) arm.tick([&] { arm.targets[1] = arm.master->positions()[1]; });
  arm.drives[1].inject(DriveFault::kReboot);
  ASSERT_TRUE(arm.run_while_homing());
  EXPECT_TRUE(arm.master->status(1).fault);
  arm.following = false;
  arm.run(1000);
  arm.master->reset_faults();
  ASSERT_TRUE(arm.power_up_and_enable());
  ASSERT_TRUE(arm.master->home(1));
  ASSERT_TRUE(arm.run_while_homing() && arm.run_until(DriveCondition::kEnabled));
  EXPECT_TRUE(arm.master->status(1).homed);
}

TEST(HomingDrives, lose_what_they_have_found_with_their_power) {
  HomingArm arm;
  ASSERT_TRUE(arm.power_up_and_enable() && arm.master->home(1));
  ASSERT_TRUE(arm.run_while_homing() && arm.run_until(DriveCondition::kEnabled));
  arm.master->disable();
  arm.following = false;
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  arm.drives[1].inject(DriveFault::kReboot);
  arm.run(100);
  arm.master->reset_faults();
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  EXPECT_FALSE(arm.master->status(1).homed);
  EXPECT_NEAR(arm.master->positions()[1], 0, 1e-4);
}

}  // namespace
}  // namespace armsig::canopen
