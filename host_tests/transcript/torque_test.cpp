// SPDX-License-Identifier: MIT
// The torque that drives tell in every cycle, where it is configured.
#include <array>

#include <gtest/gtest.h>

#include "host_tests/support/emulated_arm.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_drives.hpp"

namespace armsig::canopen {
namespace {

using hal::DriveCondition;
using test::EmulatedArm;

constexpr double kCountsPerRadian = 400000 / (2 * kPi);
constexpr double kRated = 20 * kCountsPerRadian;  // counts/s^2

Configuration telling(std::uint8_t joints) {
  Configuration configuration = test::puma_drives(joints);
  for (AxisConfiguration& axis : configuration.axes) axis.torque_told = true;
  return configuration;
}

simulated::DriveConfiguration motor() {
  simulated::DriveConfiguration drive;
  drive.motion.rated_acceleration = kRated;
  return drive;
}

// By how much of its rated torque a limb pulls that falls at `part` of the rated acceleration.
TEST(Torque, is_told_with_its_sign_in_shares_of_the_rated_one) {
  EmulatedArm arm(telling(3), nullptr, motor());
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.drives[0].set_gravity(0.25 * kRated);
  arm.drives[1].set_gravity(-0.6 * kRated);
  arm.drives[2].set_gravity(-5 * kRated);
  arm.run(100);
  EXPECT_NEAR(*arm.master->status(0).torque, -0.25, 1e-3);
  EXPECT_NEAR(*arm.master->status(1).torque, 0.6, 1e-3);
  EXPECT_NEAR(*arm.master->status(2).torque, 3, 1e-3) << "as much as the motor can give";
  EXPECT_EQ(arm.master->counters().malformed, 0U);
}

TEST(Torque, is_not_known_of_a_drive_that_is_not_to_tell_it) {
  Configuration configuration = test::puma_drives(2);
  configuration.axes[1].torque_told = true;
  EmulatedArm arm(configuration, nullptr, motor());
  EXPECT_FALSE(arm.master->status(1).torque) << "before it has told";
  ASSERT_TRUE(arm.power_up_and_enable());
  EXPECT_FALSE(arm.master->status(0).torque);
  EXPECT_TRUE(arm.master->status(1).torque);
  EXPECT_EQ(arm.master->counters().malformed, 0U);
}

TEST(Torque, is_forgotten_with_what_else_a_drive_told_when_it_is_set_up_anew) {
  EmulatedArm arm(telling(1), nullptr, motor());
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.drives[0].inject(simulated::DriveFault::kReboot);
  arm.run(50);
  arm.following = false;
  arm.master->reset_faults();
  arm.run(1);
  EXPECT_FALSE(arm.master->status(0).has_position);
  EXPECT_FALSE(arm.master->status(0).torque);
}

TEST(Torque, of_each_axis_of_a_node_is_its_own) {
  Configuration configuration = telling(2);
  configuration.axes[1].node = configuration.axes[0].node;
  configuration.axes[1].axis = 2;
  EmulatedArm arm(configuration, nullptr, motor());
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.drives[0].set_gravity(0.25 * kRated);
  arm.drives[1].set_gravity(-0.5 * kRated);
  arm.run(100);
  EXPECT_NEAR(*arm.master->status(0).torque, -0.25, 1e-3);
  EXPECT_NEAR(*arm.master->status(1).torque, 0.5, 1e-3);
}

TEST(Torque, of_a_drive_that_has_none_is_a_refusal_before_anything_is_written) {
  constexpr std::array<simulated::ObjectEdit, 1> kNoTorque{
      {{.object = {0x6077, 0, 2, simulated::Access::kAbsent, 0}}}};
  simulated::DriveConfiguration drive = motor();
  drive.edits = kNoTorque;
  EmulatedArm arm(telling(1), nullptr, drive);
  ASSERT_TRUE(arm.run_until(DriveCondition::kFaulted));
  const hal::DriveStatus status = arm.master->status(0);
  EXPECT_EQ(status.fault, Error::kSdoAborted);
  EXPECT_EQ(status.fault_object.index, 0x6077);
  EXPECT_EQ(arm.drives[0].dictionary().get(0x1017), 0U);
}

TEST(Torque, takes_its_two_bytes_of_the_bus) {
  Configuration configuration = test::puma_drives(6);
  const double without = periodic_load(configuration);
  const double with = periodic_load(telling(6));
  // Two bytes more in 2 ms, of six drives: 16 bits each, and a stuffed one after four of them.
  EXPECT_NEAR(with - without, 6 * 20 / 2000.0, 1e-9);
}

TEST(Torque, makes_a_frame_without_it_malformed) {
  EmulatedArm arm(telling(1), nullptr, motor());
  ASSERT_TRUE(arm.power_up_and_enable());
  simulated::VirtualCanPort stranger;
  arm.bus.connect(stranger);
  hal::CanFrame frame{.id = kTransmitPdo1Id + 1, .length = kDrivePdoBytes};
  ASSERT_TRUE(stranger.send(frame));
  arm.run(2);
  EXPECT_EQ(arm.master->counters().malformed, 1U);
}

}  // namespace
}  // namespace armsig::canopen
