// SPDX-License-Identifier: MIT
// CiA 402 without any CAN: drives at the other end of no wire at all, to which setpoints and status
// words are handed in the same process.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "hal/cia402/group.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::cia402 {
namespace {

using std::chrono::milliseconds;

constexpr hal::Duration kPeriod = milliseconds(2);
constexpr DriveSettings kSettings{.scaling = {.counts_per_revolution = 4000, .gear_ratio = 100},
                                  .limits = {radians(-170), radians(170)},
                                  .largest_speed = 2.0};

// Obeys every controlword at once; a quick stop takes the speed off little by little.
struct Device {
  std::uint16_t word = 0x0250;  // Switch on disabled, with voltage
  std::int32_t counts = 5000;
  std::int32_t speed = 0;  // counts a cycle, of the quick stop's ramp
  bool obeys_targets = true;
  std::vector<std::uint16_t> commands;

  void obey(const Setpoint& setpoint) {
    if (commands.empty() || commands.back() != setpoint.control_word) {
      commands.push_back(setpoint.control_word);
    }
    const bool enabled = (word & 0x6FU) == 0x27;
    if (enabled && obeys_targets && setpoint.control_word == 0x0F) {
      speed = setpoint.target_counts - counts;
      counts = setpoint.target_counts;
    }
    if ((word & 0x6FU) == 0x07) {
      speed -= speed > 0 ? 1 : 0;
      counts += speed;
    }
    if ((word & 0x4FU) == 0x08) return;
    switch (setpoint.control_word) {
      case 0x00:
        word = 0x0250;
        break;
      case 0x02:
        word = has_torque() ? 0x0217 : 0x0250;
        break;
      case 0x06:
        word = 0x0231;
        break;
      case 0x07:
        word = 0x0233;
        break;
      case 0x0F:
        word = obeys_targets ? 0x1237 : 0x0237;  // bit 12: follows its target
        break;
      default:
        ADD_FAILURE() << "controlword " << setpoint.control_word;
    }
  }
  [[nodiscard]] bool has_torque() const { return (word & 0x6FU) == 0x27 || (word & 0x6FU) == 0x07; }
};

struct Arm {
  GroupSettings settings;
  std::array<Device, 2> devices;
  std::array<Drive, 2> drives{Drive(kSettings, *Scaling::make(kSettings.scaling)),
                              Drive(kSettings, *Scaling::make(kSettings.scaling))};
  Group group{settings};
  JointVector targets;
  hal::Instant now{};
  Result<void> taken;  // the targets of the last tick

  Arm() {
    for (Drive& drive : drives) group.add(drive);
    tick();
    for (const Drive& drive : drives) targets.push_back(drive.state().position);
  }
  void tick() {
    now += kPeriod;
    for (std::size_t i = 0; i < drives.size(); ++i) {
      drives[i].hear(devices[i].word, devices[i].counts, now);
      drives[i].supervise(settings, now);
    }
    group.supervise(now);
    if (!targets.empty()) taken = group.set_targets(targets, now);
    for (std::size_t i = 0; i < drives.size(); ++i) {
      devices[i].obey(drives[i].command(group.may_release()));
    }
  }
  void run(hal::Duration time) {
    for (const hal::Instant end = now + time; now < end;) tick();
  }
  void enable() {
    run(milliseconds(100));  // is known to stand
    group.set_goal(Goal::kEnabled, now);
    run(milliseconds(100));
    ASSERT_EQ(drives[0].status().condition, hal::DriveCondition::kEnabled);
    ASSERT_EQ(drives[1].status().condition, hal::DriveCondition::kEnabled);
  }
  // Joint 0 turns at `speed` rad/s.
  void turn(double speed, hal::Duration time) {
    for (const hal::Instant end = now + time; now < end;) {
      targets[0] += speed * hal::seconds(kPeriod);
      tick();
    }
  }
};

TEST(Cia402Group, enables_by_the_transitions_of_the_standard) {
  Arm arm;
  arm.enable();
  EXPECT_EQ(arm.devices[0].commands, (std::vector<std::uint16_t>{0x00, 0x06, 0x07, 0x0F}));
}

TEST(Cia402Group, sends_targets_to_enabled_drives_and_their_own_place_to_others) {
  Arm arm;
  arm.targets[0] += 0.5;
  arm.run(milliseconds(50));
  EXPECT_EQ(arm.devices[0].counts, 5000);
  arm.targets[0] -= 0.5;
  arm.enable();
  arm.turn(1.0, milliseconds(100));
  EXPECT_NEAR(arm.drives[0].state().position, arm.targets[0], 0.01);
  EXPECT_EQ(arm.devices[1].counts, 5000);
}

TEST(Cia402Group, takes_no_torque_off_before_every_joint_stands) {
  Arm arm;
  arm.enable();
  arm.turn(1.0, milliseconds(200));
  arm.group.set_goal(Goal::kDisabled, arm.now);
  int ticks_of_motion = 0;  // at more than the half degree a second that counts as standing
  for (int i = 0; i < 300 && (i < 2 || arm.devices[0].speed > 2); ++i, ++ticks_of_motion) {
    arm.tick();
    EXPECT_TRUE(arm.devices[0].has_torque() && arm.devices[1].has_torque())
        << "in mid-ramp, at " << arm.devices[0].speed << " counts a cycle";
  }
  EXPECT_GT(ticks_of_motion, 50);
  arm.run(milliseconds(100));
  EXPECT_FALSE(arm.devices[0].has_torque());
  EXPECT_FALSE(arm.devices[1].has_torque());
  EXPECT_FALSE(arm.drives[0].state().fault);
}

TEST(Cia402Group, lets_a_joint_go_that_does_not_stop_in_time_and_says_so) {
  Arm arm;
  arm.enable();
  arm.turn(1.0, milliseconds(100));
  arm.group.set_goal(Goal::kStopped, arm.now);
  for (const hal::Instant end = arm.now + arm.settings.stop_timeout + 2 * kPeriod; arm.now < end;) {
    arm.tick();
    arm.devices[0].counts += 100;  // is driven on
  }
  EXPECT_EQ(arm.drives[0].status().fault, Error::kStopTimeout);
  EXPECT_TRUE(arm.group.may_release());
}

TEST(Cia402Group, stops_every_drive_for_the_fault_of_one) {
  Arm arm;
  arm.enable();
  arm.devices[1].word = 0x0218;  // Fault
  arm.run(milliseconds(10));
  EXPECT_EQ(arm.drives[1].status().fault, Error::kDriveFault);
  EXPECT_EQ(arm.devices[0].commands[4], 0x02) << "quick stop";
  EXPECT_EQ(arm.drives[0].state().goal, Goal::kStopped);
}

TEST(Cia402Group, does_not_believe_a_drive_that_ignores_its_targets) {
  Arm arm;
  arm.enable();
  arm.devices[0].obeys_targets = false;
  arm.devices[0].word = 0x0237;
  arm.run(arm.settings.status_limits.ignores);
  EXPECT_FALSE(arm.drives[0].state().fault);
  arm.run(2 * kPeriod);
  EXPECT_EQ(arm.drives[0].status().fault, Error::kTargetsIgnored);
}

TEST(Cia402Group, refuses_a_target_that_would_jump_or_leave_the_limits) {
  Arm arm;
  arm.enable();
  const double here = arm.targets[0];
  arm.targets[0] = here + 0.1;
  arm.tick();
  EXPECT_EQ(test::failure_of(arm.taken), Error::kTargetStep);
  arm.targets[0] = radians(171);
  arm.tick();
  EXPECT_EQ(test::failure_of(arm.taken), Error::kJointLimit);
  EXPECT_EQ(arm.devices[0].counts, 5000);
}

TEST(Cia402Drive, tells_of_its_statusword_the_limit_and_the_warning_each) {
  Drive drive(kSettings, *Scaling::make(kSettings.scaling));
  for (const bool limited : {false, true}) {
    for (const bool warns : {false, true}) {
      const auto word =
          static_cast<std::uint16_t>(0x0250 | (limited ? 1 << 11 : 0) | (warns ? 1 << 7 : 0));
      drive.hear(word, 5000, hal::Instant{});
      EXPECT_EQ(drive.status().limit_active, limited);
      EXPECT_EQ(drive.status().warning, warns);
      EXPECT_EQ(drive.status().status_word, word);
    }
  }
}

TEST(Cia402Drive, goes_on_with_a_warning_that_is_known) {
  DriveSettings known = kSettings;
  known.warning_known = true;
  for (const DriveSettings& settings : {kSettings, known}) {
    Drive drive(settings, *Scaling::make(kSettings.scaling));
    hal::Instant now{};
    drive.set_goal(Goal::kEnabled, now);
    for (int i = 0; i < 1100; ++i) {
      drive.hear(0x1237 | kStatusWarning, 5000, now += kPeriod);
      drive.supervise({}, now);
    }
    EXPECT_TRUE(drive.status().warning);
    EXPECT_EQ(drive.status().fault.has_value(), !settings.warning_known);
  }
}

// Else the others of its group would wait for it until their time is over.
TEST(Cia402Drive, stands_once_it_is_forgotten) {
  const GroupSettings settings;
  Drive drive(kSettings, *Scaling::make(kSettings.scaling));
  hal::Instant now{};
  for (const std::int32_t counts : {5000, 5100, 5200}) {
    drive.hear(0x0237, counts, now += kPeriod);
    drive.supervise(settings, now);
  }
  ASSERT_FALSE(drive.state().stands);
  drive.forget();
  EXPECT_TRUE(drive.state().stands);
}

TEST(Cia402Drive, is_let_go_without_torque_or_when_it_is_not_heard_or_takes_too_long) {
  constexpr std::uint16_t kWithTorque = 0x0217;  // Quick stop active
  const auto left_at = [](std::uint16_t word, hal::Instant at) {
    Drive drive(kSettings, *Scaling::make(kSettings.scaling));
    drive.hear(word, 5000, at);
    drive.leave(false);
    return drive;
  };
  const hal::Instant now = hal::Instant{} + std::chrono::seconds(1);
  EXPECT_TRUE(left_at(0x0250, now).has_let_go(now));
  EXPECT_TRUE(left_at(kWithTorque, now - milliseconds(51)).has_let_go(now));
  Drive drive = left_at(kWithTorque, now);
  EXPECT_FALSE(drive.has_let_go(now));
  drive.hear(kWithTorque, 5000, now + milliseconds(200));
  EXPECT_FALSE(drive.has_let_go(now + milliseconds(200)));
  EXPECT_TRUE(drive.has_let_go(now + milliseconds(201)));
  Drive stays(kSettings, *Scaling::make(kSettings.scaling));
  EXPECT_FALSE(stays.has_let_go(now)) << "does not leave";
}

// Four times the largest speed, over the time that passed and 2 ms.
TEST(Cia402Drive, believes_a_position_that_the_time_since_the_last_one_allows) {
  constexpr double kCountsPerRadian = 400000 / (2 * kPi);
  for (const int after_ms : {1, 20, 100}) {
    const double farthest = 4 * 2.0 * (after_ms + 2) * 1e-3;
    for (const double way : {0.98, 1.02, -0.98, -1.02}) {
      Arm arm;
      arm.enable();
      Drive drive = arm.drives[0];
      const auto moved = static_cast<std::int32_t>(way * farthest * kCountsPerRadian);
      drive.hear(0x1237, 5000 + moved, arm.now + milliseconds(after_ms));
      EXPECT_EQ(drive.state().fault.has_value(), std::fabs(way) > 1) << after_ms << " " << way;
    }
  }
}

// A planner that goes at the largest speed is not refused for its rounding: a quarter and two
// counts are given to it.
TEST(Cia402Group, takes_targets_a_quarter_and_two_counts_faster_than_the_largest_speed) {
  constexpr double kStep = 1.25 * 2.0 * 2e-3;  // margin, speed, period
  const double count = Scaling::make(kSettings.scaling)->resolution();
  Arm arm;
  arm.enable();
  arm.targets[0] += kStep + 1.9 * count;
  arm.tick();
  EXPECT_TRUE(arm.taken);
  arm.targets[0] += kStep + 2.1 * count;
  arm.tick();
  EXPECT_EQ(test::failure_of(arm.taken), Error::kTargetStep);
}

TEST(Cia402Group, lets_a_target_make_up_for_four_missed_periods_and_no_more) {
  constexpr double kStep = 1.25 * 2.0 * 2e-3;
  const double count = Scaling::make(kSettings.scaling)->resolution();
  Arm arm;
  arm.enable();
  for (const int missed : {2, 4, 100}) {
    Drive drive = arm.drives[0];
    const hal::Instant later = arm.now + missed * kPeriod;
    const double largest = std::min(missed, 4) * kStep;
    const double beyond = arm.targets[0] + largest + 2.1 * count;
    const double within = arm.targets[0] + largest + 1.9 * count;
    EXPECT_EQ(test::failure_of(drive.set_target(beyond, true, kPeriod, later)), Error::kTargetStep)
        << missed;
    EXPECT_TRUE(drive.set_target(within, true, kPeriod, later)) << missed;
  }
}

TEST(Cia402Group, refuses_targets_beyond_either_limit_and_tells_the_first_joint) {
  Arm arm;
  arm.enable();
  const JointVector at = arm.targets;
  arm.targets[1] = kSettings.limits.lower - 0.1;
  arm.tick();
  ASSERT_FALSE(arm.taken);
  EXPECT_EQ(test::failure_of(arm.taken), Error::kJointLimit);
  arm.targets[1] = kSettings.limits.upper + 0.1;
  arm.tick();
  EXPECT_EQ(test::failure_of(arm.taken), Error::kJointLimit);
  arm.targets[0] = std::nan("");
  arm.tick();
  EXPECT_EQ(test::failure_of(arm.taken), Error::kNotFinite)
      << "of joint 1, though 2 is refused too";
  arm.targets = at;
  arm.tick();
  EXPECT_TRUE(arm.taken);
}

}  // namespace
}  // namespace armsig::cia402
