// SPDX-License-Identifier: MIT
// The master and emulated drives that take their targets in interpolated or profile position mode.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "host_tests/support/emulated_arm.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_drives.hpp"

namespace armsig::canopen {
namespace {

using cia402::PositionMode;
using hal::DriveCondition;
using simulated::DriveFault;

constexpr double kCountsPerRadian = 400000 / (2 * kPi);

Configuration drives_in(PositionMode mode, std::uint8_t axes = 2) {
  Configuration configuration = test::puma_drives(axes);
  for (AxisConfiguration& axis : configuration.axes) axis.mode = mode;
  return configuration;
}

// Controlword and target of every RPDO1 to node 1.
class Commands final : public simulated::CanWatcher {
 public:
  struct Command {
    std::uint16_t word;
    std::int32_t target;
  };
  std::vector<Command> commands;

 private:
  void do_see(const hal::ReceivedCanFrame& received) override {
    const hal::CanFrame& frame = received.frame;
    if (frame.id != kReceivePdo1Id + 1) return;
    commands.push_back(
        {load<std::uint16_t>(frame, 0), static_cast<std::int32_t>(load<std::uint32_t>(frame, 2))});
  }
};

// 0.3 rad in 300 ticks; how far the position was behind its target at most.
double move(test::EmulatedArm& arm) {
  double lag = 0;
  for (int i = 0; i < 300; ++i) {
    arm.tick([&] { arm.targets[0] += 0.001; });
    lag = std::max(lag, std::fabs(arm.targets[0] - arm.master->positions()[0]));
  }
  return lag;
}

TEST(PositionModes, of_interpolation_are_set_up_by_their_objects_and_follow_every_target) {
  test::EmulatedArm arm(drives_in(PositionMode::kInterpolated));
  ASSERT_TRUE(arm.power_up_and_enable());
  const auto& objects = arm.drives[0].dictionary();
  EXPECT_EQ(objects.get(0x6060), 7U);
  EXPECT_EQ(objects.get(0x1600, 2), 0x60C10120U);
  EXPECT_EQ(objects.get(0x60C2, 1), 2U);
  EXPECT_EQ(objects.get(0x60C2, 2), 0xFDU);
  EXPECT_LT(move(arm), 0.02);
  arm.run(50);
  EXPECT_NEAR(arm.drives[0].position() / kCountsPerRadian, 0.3, 1e-4);
  EXPECT_NEAR(arm.drives[1].position(), 0, 1) << "the other joint holds";
}

TEST(PositionModes, of_interpolation_are_commanded_to_interpolate_only_once_they_are_enabled) {
  test::EmulatedArm arm(drives_in(PositionMode::kInterpolated, 1));
  Commands seen;
  arm.bus.set_watcher(&seen);
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.run(5);
  EXPECT_EQ(seen.commands.back().word, 0x1F);
  const auto first = std::ranges::find(seen.commands, 0x0F, &Commands::Command::word);
  const auto interpolates = std::ranges::find(seen.commands, 0x1F, &Commands::Command::word);
  EXPECT_LT(first, interpolates) << "an edge that the drive sees in Operation enabled";
  arm.master->quick_stop();
  arm.run(1);
  EXPECT_EQ(seen.commands.back().word, 0x02);
}

TEST(PositionModes, of_interpolation_without_their_bit_12_are_said_to_ignore_their_targets) {
  test::EmulatedArm arm(drives_in(PositionMode::kInterpolated, 1));
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.drives[0].inject(DriveFault::kBitsSet, cia402::kStatusFollowingError);
  arm.run(200);
  EXPECT_FALSE(arm.master->status(0).fault) << "bit 13 has no meaning in this mode";
  arm.drives[0].inject(DriveFault::kBitsClear, cia402::kStatusFollowsTarget);
  arm.run(200);
  EXPECT_EQ(arm.master->status(0).fault, Error::kTargetsIgnored);
}

// 60C4h:6 read-only and closed: it is an option, and told.
TEST(PositionModes, of_interpolation_go_without_a_buffer_that_cannot_be_opened) {
  const std::array<simulated::ObjectEdit, 1> edits{
      {{.object = {0x60C4, 6, 1, simulated::Access::kReadOnly, 0}}}};
  simulated::DriveConfiguration drive;
  drive.edits = edits;
  test::EmulatedArm arm(drives_in(PositionMode::kInterpolated, 1), nullptr, drive);
  ASSERT_TRUE(arm.power_up_and_enable());
  EXPECT_TRUE(std::ranges::count(
      arm.master->setup_report(0).gaps,
      hal::DeviceObject{.index = 0x60C4, .subindex = 6, .found = 0, .wanted = 1}));
}

TEST(PositionModes, of_interpolation_tell_of_a_drive_that_has_no_option_at_all) {
  using simulated::Access;
  using simulated::ObjectEdit;
  std::vector<ObjectEdit> edits;
  // What it does all the same: CiA 402's own values, and a cycle of two milliseconds.
  edits.push_back({.object = {0x60C2, 1, 1, Access::kAbsent, 2}});
  edits.push_back({.object = {0x60C2, 2, 1, Access::kAbsent, 0xFD}});
  for (const std::uint16_t index :
       std::array<std::uint16_t, 7>{0x605A, 0x605B, 0x605C, 0x605E, 0x6007, 0x60C0, 0x60B0}) {
    edits.push_back({.object = {index, ObjectEdit::kWhole, 0, Access::kAbsent, index < 0x6080}});
  }
  for (const std::uint16_t index : std::array<std::uint16_t, 2>{0x1006, 0x1016}) {
    edits.push_back({.object = {index, ObjectEdit::kWhole, 0, Access::kAbsent, 0}});
  }
  simulated::DriveConfiguration drive;
  drive.edits = edits;
  Configuration configuration = drives_in(PositionMode::kInterpolated, 1);
  configuration.axes[0].unsupervised_known = true;
  test::EmulatedArm arm(configuration, nullptr, drive);
  ASSERT_TRUE(arm.power_up_and_enable());
  const auto& gaps = arm.master->setup_report(0).gaps;
  EXPECT_EQ(gaps.size(), 15U)
      << "five of CiA 301 (1016h, 1400h:5, 100Ch, 100Dh, 1006h), ten of CiA 402";
  EXPECT_LT(move(arm), 0.02);
}

TEST(PositionModes, of_profiles_arrive_and_are_behind_by_no_more_than_their_ramp_takes) {
  simulated::DriveConfiguration drive;
  drive.motion.stop_deceleration = 20 * kCountsPerRadian;
  test::EmulatedArm arm(drives_in(PositionMode::kProfile), nullptr, drive);
  ASSERT_TRUE(arm.power_up_and_enable());
  EXPECT_EQ(arm.drives[0].dictionary().get(0x6060), 1U);
  // 0.5 rad/s on ramps of 20 rad/s^2: v^2 / 2a = 6 mrad, what the loop takes (v / 79 /s = 6 mrad),
  // and the ramp at the start.
  EXPECT_LT(move(arm), 0.03);
  arm.run(200);
  EXPECT_FALSE(arm.master->status(0).fault);
  EXPECT_NEAR(arm.drives[0].position() / kCountsPerRadian, 0.3, 1e-4);
  EXPECT_NEAR(arm.drives[1].position(), 0, 1) << "the other joint holds";
}

// CiA 402-2: an offer stands until it is taken, the next begins after bit 12 is gone, and what is
// offered does not change meanwhile.
TEST(PositionModes, of_profiles_offer_one_target_after_the_other) {
  test::EmulatedArm arm(drives_in(PositionMode::kProfile, 1));
  Commands seen;
  arm.bus.set_watcher(&seen);
  ASSERT_TRUE(arm.power_up_and_enable());
  move(arm);
  arm.run(20);
  std::size_t offers = 0;
  for (std::size_t i = 1; i < seen.commands.size(); ++i) {
    const auto [word, target] = seen.commands[i];
    const bool offered = (word & 0x10) != 0;
    if (offered) EXPECT_EQ(word, 0x3F) << "at once, absolute";
    if (offered && (seen.commands[i - 1].word & 0x10) != 0) {
      EXPECT_EQ(target, seen.commands[i - 1].target);
    } else if (offered) {
      ++offers;
    }
  }
  EXPECT_GT(offers, 40U);
  EXPECT_EQ(seen.commands.back().word, 0x2F) << "nothing is offered at the end";
  EXPECT_NEAR(seen.commands.back().target, 0.3 * kCountsPerRadian, 1);
}

TEST(PositionModes, of_profiles_that_take_no_target_are_said_to_ignore_them) {
  test::EmulatedArm arm(drives_in(PositionMode::kProfile, 1));
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.drives[0].inject(DriveFault::kIgnoresTargets);
  move(arm);
  EXPECT_EQ(arm.master->status(0).fault, Error::kTargetsIgnored);
}

TEST(PositionModes, of_profiles_that_never_take_back_their_answer_are_said_to_ignore_targets) {
  test::EmulatedArm arm(drives_in(PositionMode::kProfile, 1));
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.drives[0].inject(DriveFault::kBitsSet, cia402::kStatusTargetTaken);
  move(arm);
  EXPECT_EQ(arm.master->status(0).fault, Error::kTargetsIgnored);
}

TEST(PositionModes, of_profiles_without_a_speed_or_a_ramp_are_refused_by_the_object) {
  for (const std::uint16_t index : std::array<std::uint16_t, 3>{0x6081, 0x6083, 0x6084}) {
    test::EmulatedArm arm(drives_in(PositionMode::kProfile, 1));
    arm.drives[0].set_object(index, 0, 0);
    for (int i = 0; i < 1000 && !arm.master->status(0).fault; ++i) arm.tick();
    EXPECT_EQ(arm.master->status(0).fault, Error::kSdoUnexpectedValue);
    EXPECT_EQ(arm.master->status(0).fault_object,
              (hal::DeviceObject{.index = index, .subindex = 0, .found = 0, .wanted = 1}));
  }
}

TEST(PositionModes, that_a_drive_does_not_have_are_refused_by_its_modes) {
  for (const auto mode :
       {PositionMode::kProfile, PositionMode::kInterpolated, PositionMode::kCyclic}) {
    test::EmulatedArm arm(drives_in(mode, 1));
    const std::uint32_t bit = 1U << (static_cast<unsigned>(mode) - 1);
    arm.drives[0].set_object(0x6502, 0, 0xE1U & ~bit);
    for (int i = 0; i < 1000 && !arm.master->status(0).fault; ++i) arm.tick();
    EXPECT_EQ(arm.master->status(0).fault, Error::kDriveWrongType);
    EXPECT_EQ(
        arm.master->status(0).fault_object,
        (hal::DeviceObject{.index = 0x6502, .subindex = 0, .found = 0xE1U & ~bit, .wanted = bit}));
  }
}

TEST(PositionModes, are_told_again_after_a_drive_has_homed) {
  for (const auto mode : {PositionMode::kProfile, PositionMode::kInterpolated}) {
    simulated::DriveConfiguration drive;
    drive.counts_anew = true;
    drive.home_switch = 2000;
    Configuration configuration = drives_in(mode);
    configuration.axes[0].homing_method = 17;
    test::EmulatedArm arm(configuration, nullptr, drive);
    ASSERT_TRUE(arm.power_up_and_enable() && arm.master->home(0));
    for (int i = 0; i < 5000 && !arm.master->status(0).homed; ++i) {
      arm.tick([&] { arm.targets[0] = arm.master->positions()[0]; });
    }
    ASSERT_TRUE(arm.run_until(DriveCondition::kEnabled));
    EXPECT_EQ(arm.drives[0].dictionary().get(0x6060), static_cast<std::uint32_t>(mode));
    arm.targets[0] = arm.master->positions()[0];
    const double from = arm.targets[0];
    move(arm);
    arm.run(300);
    EXPECT_NEAR(arm.master->positions()[0], from + 0.3, 1e-4);
  }
}

// A stop is the drive's own ramp in every mode; afterwards the joint holds where it came to rest.
TEST(PositionModes, stop_and_hold_where_they_came_to_rest) {
  for (const auto mode : {PositionMode::kProfile, PositionMode::kInterpolated}) {
    test::EmulatedArm arm(drives_in(mode, 1));
    ASSERT_TRUE(arm.power_up_and_enable());
    for (int i = 0; i < 100; ++i) arm.tick([&] { arm.targets[0] += 0.002; });
    arm.master->quick_stop();
    ASSERT_TRUE(arm.run_until(DriveCondition::kStopped));
    const double stands = arm.drives[0].position();
    arm.following = false;
    ASSERT_TRUE(arm.master->enable());
    ASSERT_TRUE(arm.run_until(DriveCondition::kEnabled));
    arm.following = true;
    arm.run(300);
    EXPECT_NEAR(arm.drives[0].position(), stands, 2) << "no target of before is gone for";
  }
}

TEST(FurtherWrites, are_written_where_the_drive_holds_something_else_and_refused_by_their_object) {
  Configuration configuration = drives_in(PositionMode::kProfile, 1);
  configuration.axes[0].writes = {{0x6081, 0, 4, 12345}, {0x6083, 0, 4, 54321}};
  test::EmulatedArm arm(configuration);
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  EXPECT_EQ(arm.drives[0].dictionary().get(0x6081), 12345U);
  EXPECT_EQ(arm.drives[0].dictionary().get(0x6083), 54321U);
  configuration.axes[0].writes = {{0x2345, 6, 2, 1}};
  test::EmulatedArm other(configuration);
  for (int i = 0; i < 1000 && !other.master->status(0).fault; ++i) other.tick();
  EXPECT_EQ(other.master->status(0).fault, Error::kSdoAborted);
  EXPECT_EQ(other.master->status(0).fault_object,
            (hal::DeviceObject{.index = 0x2345, .subindex = 6, .found = {}, .wanted = 1}));
}

}  // namespace
}  // namespace armsig::canopen
