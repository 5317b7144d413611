// SPDX-License-Identifier: MIT
// Drives with two axes in a node: what a master writes of each, frame by frame, by the numbers of
// CiA 301 and CiA 402 (800h further in the profile, 40h further of the PDOs), and what befalls one
// axis or the node.
#include <chrono>
#include <string>

#include <gtest/gtest.h>

#include "hal/canopen/master.hpp"
#include "host_tests/support/emulated_arm.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/master_script.hpp"

namespace armsig::canopen {
namespace {

using hal::DriveCondition;
using test::EmulatedArm;
using test::MasterScript;
using test::puma_on_dual_drives;

// Until both axes are asked what they do, and the node is reset once.
void script_reset_of_both(test::ScriptedCanBus& bus) {
  bus.expect("601#4041600000000000", {"581#4B41600050020000"});
  bus.expect("601#4041680000000000", {"581#4B41680050020000"});
  bus.expect("000#8201", {"701#00"});
}

// What the second axis is asked and told. The objects of the node are read, and left.
void script_second_axis(test::ScriptedCanBus& bus) {
  bus.expect("601#40FF6F0000000000", {"581#43FF6F0092010200"});  // 6FFFh: CiA 402 servo drive
  bus.expect("601#40026D0000000000", {"581#43026D0080000000"});  // 6D02h: CSP
  bus.expect("601#407E680000000000", {"581#4F7E680000000000"});  // 687Eh: none
  for (const char* subindex : {"01", "02", "03", "04"}) {
    bus.expect("601#401810" + std::string(subindex) + "00000000", {"581#4318100100000000"});
    bus.replace("601#401810" + std::string(subindex) + "00000000",
                ("581#431810" + std::string(subindex) + "07000000").c_str());
  }
  for (const char* object : {"8F68", "9168", "9268", "9368"}) {
    for (const char* subindex : {"01", "02"}) {
      const std::string name = std::string(object) + subindex;
      bus.expect("601#40" + name + "00000000", {("581#80" + name + "00000206").c_str()});
    }
  }
  bus.expect("601#40A8680000000000", {"581#80A8680000000206"});
  bus.expect("601#40AA680000000000", {"581#80AA680000000206"});
  bus.expect("601#4016100100000000", {"581#4316100196007F00"});  // as the first axis left it
  bus.expect("601#4017100000000000", {"581#4B17100032000000"});
  bus.expect("601#4006100000000000", {"581#43061000D0070000"});
  bus.expect("601#2301140101030080", {"581#6001140100000000"});  // RPDO2 of the first axis
  bus.expect("601#23011801810200C0", {"581#6001180100000000"});
  bus.expect("601#2302140101040080", {"581#8002140100000206"});
  bus.expect("601#23021801810300C0", {"581#8002180100000206"});
  bus.expect("601#2303140101050080", {"581#8003140100000206"});
  bus.expect("601#23031801810400C0", {"581#8003180100000206"});
  bus.expect("601#2341140101030080", {"581#8041140100000206"});  // RPDO2 of the second: 1441h
  bus.expect("601#23411801810200C0", {"581#8041180100000206"});
  bus.expect("601#2342140101040080", {"581#8042140100000206"});
  bus.expect("601#23421801810300C0", {"581#8042180100000206"});
  bus.expect("601#2343140101050080", {"581#8043140100000206"});
  bus.expect("601#23431801810400C0", {"581#8043180100000206"});
  bus.expect("601#2340140101030080", {"581#6040140100000000"});  // 1440h: off
  bus.expect("601#2F40140201000000", {"581#6040140200000000"});
  bus.expect("601#2F40160000000000", {"581#6040160000000000"});
  bus.expect("601#2340160110004068", {"581#6040160100000000"});  // 6840h, 16 bits
  bus.expect("601#2340160220007A68", {"581#6040160200000000"});  // 687Ah, 32 bits
  bus.expect("601#2F40160002000000", {"581#6040160000000000"});
  bus.expect("601#2340140101030000", {"581#6040140100000000"});  // on: 301h
  bus.expect("601#23401801810200C0", {"581#6040180100000000"});  // 1840h: off
  bus.expect("601#2F40180201000000", {"581#6040180200000000"});
  bus.expect("601#2F401A0000000000", {"581#60401A0000000000"});
  bus.expect("601#23401A0110004168", {"581#60401A0100000000"});  // 6841h, 16 bits
  bus.expect("601#23401A0220006468", {"581#60401A0200000000"});  // 6864h, 32 bits
  bus.expect("601#2F401A0002000000", {"581#60401A0000000000"});
  bus.expect("601#2340180181020040", {"581#6040180100000000"});  // on: 281h
  bus.expect("601#40C2680100000000", {"581#4FC2680102000000"});  // 68C2h: 2 times 10^-3 s already
  bus.expect("601#40C2680200000000", {"581#4FC26802FD000000"});
  bus.expect("601#4007680000000000", {"581#4B07680003000000"});  // 6807h: quick stop already
  bus.expect("601#405A680000000000", {"581#4B5A680006000000"});  // 685Ah
  bus.expect("601#405B680000000000", {"581#805B680000000206"});  // 685Bh: does not exist
  bus.expect("601#405C680000000000", {"581#4B5C680001000000"});
  bus.expect("601#405E680000000000", {"581#4B5E680002000000"});
  bus.expect("601#40B0680000000000", {"581#80B0680000000206"});
  bus.expect("601#2F60680008000000", {"581#6060680000000000"});  // 6860h: mode 8 ...
  bus.expect("601#4061680000000000", {"581#4F61680008000000"});  // ... in force, 6861h
}

// The first axis as a drive of its own, but for the start, which the node has once.
void script_both_axes(test::ScriptedCanBus& bus) {
  test::script_set_up(bus);
  bus.leave_out_last();
  script_second_axis(bus);
  bus.expect("000#0101");
}

void tick_until_started(MasterScript& script) {
  for (int i = 0; i < 180 && script.master->node_state(1).phase < Phase::kStarted; ++i) {
    script.tick({});
  }
}

TEST(DualAxis, sets_up_both_axes_by_their_own_objects_and_the_node_once) {
  MasterScript script(puma_on_dual_drives(2));
  script.bus.expect("77F#05");
  script_reset_of_both(script.bus);
  script_both_axes(script.bus);
  tick_until_started(script);
  script.bus.expect_all_consumed();
  EXPECT_EQ(script.master->node_state(0).phase, Phase::kStarted);
  EXPECT_EQ(script.master->node_state(1).phase, Phase::kStarted);
  EXPECT_FALSE(script.master->node_state(1).unsupervised) << "watched by the node's 1016h";
  // A gap is told by the object's own number.
  ASSERT_TRUE(script.master->gap(1, 0));
  EXPECT_EQ(script.master->gap(1, 0)->index, 0x685B);
  EXPECT_EQ(script.master->identity(0)->axis, 1);
  EXPECT_EQ(script.master->identity(1)->axis, 2);

  script.bus.expect("080#", {"181#5002E8030000", "281#5002D0070000"});
  script.bus.expect("201#0000E8030000");
  script.bus.expect("301#0000D0070000");
  script.tick({});
  script.bus.expect_all_consumed();
  EXPECT_EQ(script.master->drive_state(0).actual_counts, 1000);
  EXPECT_EQ(script.master->drive_state(1).actual_counts, 2000);
  EXPECT_TRUE(script.master->all(DriveCondition::kDisabled));
}

TEST(DualAxis, refuses_a_wrong_mode_by_the_object_of_the_second_axis) {
  MasterScript script(puma_on_dual_drives(2));
  script.bus.expect("77F#05");
  script_reset_of_both(script.bus);
  test::script_set_up(script.bus);
  script.bus.leave_out_last();
  script.bus.expect("601#40FF6F0000000000", {"581#80FF6F0000000206"});  // 6FFFh: does not exist
  script.bus.expect("601#40026D0000000000", {"581#43026D0001000000"});  // profile position alone
  script.bus.expect("000#0101");  // the first axis tells where it is
  tick_until_started(script);
  script.bus.expect_all_consumed();
  const hal::DriveStatus refused = script.master->status(1);
  EXPECT_EQ(refused.fault, Error::kDriveWrongType);
  EXPECT_EQ(refused.fault_object,
            (hal::DeviceObject{.index = 0x6D02, .subindex = 0, .found = 1, .wanted = 0x80}));
  EXPECT_EQ(script.master->node_state(0).phase, Phase::kStarted);
  EXPECT_FALSE(script.master->enable());
}

TEST(DualAxis, finds_both_axes_at_rest_before_it_resets_the_node) {
  MasterScript script(puma_on_dual_drives(2));
  script.bus.expect("77F#05");
  script.bus.expect("601#4041600000000000", {"581#4B41600037120000"});
  script.bus.expect("601#4041680000000000", {"581#4B41680037120000"});
  script.bus.expect("601#2B40600002000000", {"581#6040600000000000"});
  script.bus.expect("601#2B40680002000000", {"581#6040680000000000"});
  for (int i = 0; i < 4; ++i) script.tick();
  // Then their positions, in turn: one answer at a time is asked of the device.
  for (int i = 0; i < 6; ++i) {
    script.bus.expect("601#4064600000000000", {"581#4364600000100000"});
    script.tick(std::chrono::milliseconds(5));
    if (i == 4) script.bus.expect("77F#05");
    script.bus.expect("601#4064680000000000", {"581#4364680000100000"});
    script.tick(std::chrono::milliseconds(5));
  }
  script.bus.expect("000#8201");  // 50 ms after the first position of the second axis
  script.tick(std::chrono::milliseconds(5));
  script.bus.expect_all_consumed();
  for (const std::size_t joint : {0U, 1U}) {
    EXPECT_EQ(script.master->node_state(joint).phase, Phase::kBooting);
  }
}

TEST(DualAxis, tells_both_joints_of_an_emergency_of_their_node) {
  EmulatedArm arm(puma_on_dual_drives());
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.drives[2].inject(simulated::DriveFault::kEmergency, 0x2310);
  arm.run(20);
  for (const std::size_t joint : {2U, 3U}) {
    EXPECT_EQ(arm.master->status(joint).fault, Error::kDriveEmergency) << joint;
    EXPECT_EQ(arm.master->status(joint).fault_code, 0x2310U) << joint;
  }
  EXPECT_EQ(arm.drives[2].state(), cia402::State::kFault);
  // The whole arm has stopped, the other axis of the node too, and holds.
  for (const std::size_t joint : {0U, 1U, 3U, 4U, 5U}) {
    EXPECT_EQ(arm.drives[joint].state(), cia402::State::kQuickStopActive) << joint;
  }
  EXPECT_FALSE(arm.master->status(0).fault);

  arm.drives[2].inject(simulated::DriveFault::kNone);
  arm.following = false;
  arm.master->reset_faults();
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  EXPECT_TRUE(arm.power_up_and_enable());
}

TEST(DualAxis, stops_both_axes_when_their_node_is_lost_and_sets_both_up_again) {
  EmulatedArm arm(puma_on_dual_drives());
  ASSERT_TRUE(arm.power_up_and_enable());
  for (const std::size_t joint : {2U, 3U}) {
    arm.drives[joint].inject(simulated::DriveFault::kHeartbeatLost);
  }
  arm.run(100);
  for (const std::size_t joint : {2U, 3U}) {
    EXPECT_EQ(arm.master->status(joint).fault, Error::kHeartbeatLost) << joint;
  }
  for (const std::size_t joint : {0U, 1U, 2U, 3U, 4U, 5U}) {
    EXPECT_EQ(arm.drives[joint].state(), cia402::State::kQuickStopActive) << joint;
  }
  for (const std::size_t joint : {2U, 3U}) arm.drives[joint].inject(simulated::DriveFault::kNone);
  arm.following = false;
  arm.master->reset_faults();
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  EXPECT_TRUE(arm.power_up_and_enable());
}

// The fault of one axis alone: its node is set up anew only when the other has no torque either.
TEST(DualAxis, resets_the_node_of_an_axis_whose_feedback_was_lost_when_both_have_let_go) {
  EmulatedArm arm(puma_on_dual_drives());
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.drives[3].inject(simulated::DriveFault::kFeedbackLost);
  arm.run(20);
  EXPECT_EQ(arm.master->status(3).fault, Error::kFeedbackLost);
  EXPECT_FALSE(arm.master->status(2).fault);
  arm.drives[3].inject(simulated::DriveFault::kNone);
  arm.following = false;
  arm.master->reset_faults();
  bool reset = false;
  for (int i = 0; i < 2000 && !reset; ++i) {
    arm.tick();
    reset = arm.master->node_state(2).phase == Phase::kBooting;
    if (!reset) continue;
    EXPECT_EQ(arm.master->node_state(3).phase, Phase::kBooting);
    EXPECT_FALSE(arm.drives[2].has_torque());
  }
  EXPECT_TRUE(reset);
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  EXPECT_TRUE(arm.power_up_and_enable());
}

TEST(DualAxis, tells_both_joints_that_their_node_has_booted) {
  EmulatedArm arm(puma_on_dual_drives());
  ASSERT_TRUE(arm.power_up_and_enable());
  for (const std::size_t joint : {4U, 5U}) arm.drives[joint].inject(simulated::DriveFault::kReboot);
  arm.run(50);
  for (const std::size_t joint : {4U, 5U}) {
    EXPECT_TRUE(arm.master->status(joint).fault) << joint;  // the first that is noticed
  }
  arm.following = false;
  arm.master->reset_faults();
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  EXPECT_TRUE(arm.power_up_and_enable());
}

// As the second of two joints, as the first of them, and as the only one of its node.
TEST(DualAxis, moves_axes_in_any_order_of_the_joints) {
  Configuration configuration = puma_on_dual_drives(3);
  configuration.axes[0].axis = 2;
  configuration.axes[1].axis = 1;
  configuration.axes[2].axis = 2;
  EmulatedArm arm(configuration);
  ASSERT_TRUE(arm.power_up_and_enable());
  for (int i = 0; i < 200; ++i) {
    arm.tick([&] {
      for (std::size_t joint = 0; joint < 3; ++joint) {
        arm.targets[joint] += 1e-3 * static_cast<double>(joint + 1);
      }
    });
  }
  arm.run(200);
  for (std::size_t joint = 0; joint < 3; ++joint) {
    EXPECT_NEAR(arm.master->positions()[joint], 0.2 * static_cast<double>(joint + 1), 1e-4);
  }
  EXPECT_EQ(arm.master->counters().unknown, 0U);
  EXPECT_EQ(arm.master->counters().foreign, 0U);
}

// Interpolated and profile position by the objects of each axis, and homing.
TEST(DualAxis, moves_in_every_mode) {
  for (const cia402::PositionMode mode :
       {cia402::PositionMode::kInterpolated, cia402::PositionMode::kProfile}) {
    Configuration configuration = puma_on_dual_drives(2);
    for (AxisConfiguration& axis : configuration.axes) axis.mode = mode;
    EmulatedArm arm(configuration);
    ASSERT_TRUE(arm.power_up_and_enable());
    for (int i = 0; i < 100; ++i) {
      arm.tick([&] { arm.targets[1] += 1e-3; });
    }
    arm.run(1000);
    EXPECT_NEAR(arm.master->positions()[1], 0.1, 1e-4) << static_cast<int>(mode);
    EXPECT_NEAR(arm.master->positions()[0], 0, 1e-4) << static_cast<int>(mode);
  }
}

TEST(DualAxis, takes_an_rpdo_of_either_axis_for_another_masters) {
  EmulatedArm arm(puma_on_dual_drives());
  ASSERT_TRUE(arm.power_up_and_enable());
  simulated::VirtualCanPort other;
  arm.bus.connect(other);
  ASSERT_TRUE(other.send({.id = 0x301, .length = 6}));
  arm.run(3);
  EXPECT_EQ(arm.master->status(0).fault, Error::kSecondMaster);
}

TEST(DualAxis, counts_the_heartbeat_of_a_node_once) {
  const double of_six = periodic_load(test::puma_drives());
  const double of_three = periodic_load(puma_on_dual_drives());
  EXPECT_NEAR(of_six - of_three, 3 * worst_case_bits(1) / (1e6 * 50e-3), 1e-12);
}

TEST(DualAxis, refuses_an_axis_that_two_joints_have_and_one_that_there_cannot_be) {
  Configuration configuration = puma_on_dual_drives();
  ASSERT_TRUE(check(configuration));
  configuration.axes[3].axis = 1;
  const auto twice = test::failure_of(check(configuration));
  EXPECT_EQ(twice.error, Error::kNodeTwice);
  EXPECT_EQ(twice.axis, 3U);
  for (const int axis : {0, 5, 9}) {
    configuration.axes[3].axis = static_cast<std::uint8_t>(axis);
    const auto refused = test::failure_of(check(configuration));
    EXPECT_EQ(refused.error, Error::kUnsupported);
    EXPECT_EQ(refused.axis, 3U);
  }
  configuration.axes[3].axis = 2;
  configuration.others[0].nodes.push_back(3);
  EXPECT_EQ(test::failure_of(check(configuration)).error, Error::kNodeTwice);
}

}  // namespace
}  // namespace armsig::canopen
