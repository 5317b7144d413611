// SPDX-License-Identifier: MIT
// Stopping and stopped are two conditions: torque goes when every position stands, or when the time
// of the ramps is over. On drives as they are: 180 deg/s^2, gravity, slow brakes.
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host_tests/support/honest_arm.hpp"

namespace armsig::canopen {
namespace {

using cia402::State;
using hal::DriveCondition;
using simulated::DriveFault;
using test::HonestArm;

constexpr double kSpeed = 1.1;  // rad/s; 63 degrees a second
constexpr double kRamp = kPi;   // rad/s^2

// Watches every drive but `except` while the arm runs, for the speed at which torque goes.
struct Watch {
  explicit Watch(HonestArm& watched, std::size_t but = kMaxJoints) : arm(watched), except(but) {}
  void run(unsigned ticks) {
    for (unsigned i = 0; i < ticks; ++i) {
      std::array<bool, kMaxJoints> had_torque{};
      for (std::size_t j = 0; j < arm.drives.size(); ++j)
        had_torque[j] = arm.drives[j].has_torque();
      arm.tick();
      for (std::size_t j = 0; j < arm.drives.size(); ++j) {
        if (j == except) continue;
        const bool lost = had_torque[j] && !arm.drives[j].has_torque();
        if (lost) released_at = std::max(released_at, std::fabs(arm.speed(j)));
      }
    }
  }
  HonestArm& arm;
  std::size_t except;
  double released_at = 0;  // fastest speed at which torque went
};

TEST(Standstill, of_a_ramp_is_waited_for_before_disabling) {
  HonestArm arm;
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.move_at(kSpeed);
  arm.following = false;
  arm.master->disable();
  Watch watch(arm);
  const double before = arm.place(0);
  watch.run(100);  // 0.2 s into a ramp of 0.35 s
  EXPECT_TRUE(arm.drives[0].has_torque());
  EXPECT_EQ(arm.drives[0].state(), State::kQuickStopActive);
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled, 200));
  EXPECT_LT(watch.released_at, 1e-3);
  EXPECT_LT(arm.place(0) - before, kSpeed * kSpeed / (2 * kRamp) + 4 * 0.002 * kSpeed);
}

TEST(Standstill, is_told_apart_from_stopping) {
  HonestArm arm;
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.move_at(kSpeed);
  arm.following = false;
  arm.master->quick_stop();
  arm.run(50);
  EXPECT_EQ(arm.master->status(0).condition, DriveCondition::kStopping);
  ASSERT_TRUE(arm.run_until(DriveCondition::kStopped, 300));
  EXPECT_EQ(arm.speed(0), 0);
  EXPECT_TRUE(arm.drives[0].has_torque());
}

TEST(Standstill, is_waited_for_by_a_reset) {
  for (const bool with_fault : {false, true}) {
    HonestArm arm;
    ASSERT_TRUE(arm.power_up_and_enable());
    arm.move_at(kSpeed);
    arm.following = false;
    // Of the second only the heartbeat ceases: it must be set up anew.
    if (with_fault) arm.drives[1].inject(DriveFault::kHeartbeatLost);
    for (int i = 0; with_fault && i < 100 && !arm.master->status(1).fault; ++i) {
      arm.tick([&] {
        for (std::size_t j = 0; j < 3; ++j)
          arm.targets[j] = arm.master->drive_state(j).target + kSpeed * 0.002;
      });
    }
    arm.master->quick_stop();
    arm.run(3);
    ASSERT_GT(arm.speed(0), 1.0) << with_fault;
    arm.drives[1].inject(DriveFault::kNone);
    arm.master->reset_faults();
    Watch watch(arm);
    watch.run(600);
    EXPECT_LT(watch.released_at, 1e-3) << with_fault;
    EXPECT_TRUE(arm.master->all(DriveCondition::kDisabled)) << with_fault;
  }
}

TEST(Standstill, is_not_waited_for_longer_than_the_ramps_may_take) {
  HonestArm arm;
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.move_at(kSpeed);
  arm.following = false;
  arm.drives[1].inject(DriveFault::kFeedbackLost);  // nobody knows whether it stands
  arm.run(5);
  arm.master->reset_faults();
  Watch watch(arm);
  watch.run(700);  // 1.4 s of 1.5
  EXPECT_TRUE(arm.drives[0].has_torque());
  arm.drives[1].inject(DriveFault::kNone);
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled, 1000));
  EXPECT_LT(watch.released_at, 1e-3);
}

TEST(Standstill, that_does_not_come_is_a_fault_with_the_joints_name) {
  HonestArm arm;
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.move_at(kSpeed);
  arm.following = false;
  arm.master->quick_stop();
  for (int i = 0; i < 800; ++i) {
    arm.drives[2].push(20);  // 0.16 rad/s
    arm.tick();
  }
  EXPECT_EQ(arm.master->status(2).fault, Error::kStopTimeout);
  EXPECT_FALSE(arm.master->status(0).fault);
}

TEST(Standstill, is_what_the_drive_says_where_it_says_it) {
  HonestArm arm;
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.following = false;
  arm.master->quick_stop();
  ASSERT_TRUE(arm.run_until(DriveCondition::kStopped));  // bit 10 is seen
  arm.drives[0].inject(DriveFault::kBitsClear, cia402::kStatusTargetReached);
  arm.run(3);
  EXPECT_EQ(arm.master->status(0).condition, DriveCondition::kStopping);
  EXPECT_EQ(arm.master->status(1).condition, DriveCondition::kStopped);
}

// The statusword has told Quick stop active since the second tick.
TEST(Standstill, of_a_limb_under_gravity_is_kept_by_torque_and_then_by_the_brake) {
  HonestArm arm;
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.move_at(kSpeed);
  arm.following = false;
  arm.master->quick_stop();
  ASSERT_TRUE(arm.run_until(DriveCondition::kStopped, 300));
  const double stood = arm.place(0);
  arm.master->disable();
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled, 20));
  arm.run(500);
  EXPECT_EQ(arm.place(0), stood);
}

// A drive that loses its torque in mid-motion coasts and falls: what the plant does where the
// master is wrong.
TEST(HonestPlant, coasts_and_falls_where_the_torque_goes_in_motion) {
  HonestArm arm;
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.move_at(kSpeed);
  const double before = arm.place(0);
  const double acceleration = arm.gravity.pull(0) - 0.5;  // and friction
  ASSERT_GT(std::fabs(acceleration), 2);
  arm.drives[0].inject(DriveFault::kPowerRemoved);
  arm.run(60);
  const double until_brake = 0.06;
  const double speed = kSpeed + acceleration * until_brake;
  EXPECT_NEAR(arm.place(0) - before,
              0.5 * (kSpeed + speed) * until_brake + speed * speed / (2 * 50), 3e-3);
  EXPECT_EQ(arm.speed(0), 0);
}

TEST(Enabling, freezes_the_target_of_the_drive_that_is_first) {
  simulated::DriveConfiguration drive = test::honest_drive();
  drive.motion.droop = radians(0.36) * test::kHonestCountsPerRadian;
  HonestArm arm(3, drive);
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled));
  arm.drives[2].inject(DriveFault::kDeaf);
  ASSERT_TRUE(arm.master->enable());
  const double before = arm.place(0);
  arm.run(450);
  ASSERT_EQ(arm.drives[0].state(), State::kOperationEnabled);
  EXPECT_LT(std::fabs(arm.place(0) - before), radians(0.361));
}

// The process was killed and is started again while the arm moves.
TEST(Standstill, is_waited_for_by_the_first_reset_of_a_master) {
  for (const double pause_s : {0.004, 0.03}) {  // before and after the drives miss their master
    HonestArm arm;
    ASSERT_TRUE(arm.power_up_and_enable());
    arm.move_at(kSpeed);
    for (double gone_s = 0; gone_s < pause_s; gone_s += 0.002) {
      ++arm.ticks;
      arm.clock.wait_until(hal::Instant(arm.period * arm.ticks));
    }
    ASSERT_GT(arm.speed(0), 0.1) << pause_s;
    arm.master.emplace(*check(test::puma_drives(3)), arm.master_port);
    arm.following = false;
    Watch watch(arm);
    watch.run(1200);
    EXPECT_LT(watch.released_at, 1e-3) << pause_s;
    arm.master->reset_faults();  // they tell the SYNC that they missed
    arm.run(100);
    EXPECT_TRUE(arm.master->all(DriveCondition::kDisabled)) << pause_s;
  }
}

// Any speed, one thing that goes wrong with the second drive, a stop, and a reset at any time after
// it. Other histories: --gtest_random_seed=N.
TEST(Standstill, holds_in_random_histories) {
  constexpr std::array kFaults{DriveFault::kNone,           DriveFault::kDeaf,
                               DriveFault::kSilent,         DriveFault::kHeartbeatLost,
                               DriveFault::kFeedbackLost,   DriveFault::kIgnoresTargets,
                               DriveFault::kEmergency,      DriveFault::kSyncLost,
                               DriveFault::kPreOperational, DriveFault::kReboot};
  std::mt19937 random(17U + static_cast<unsigned>(testing::UnitTest::GetInstance()->random_seed()));
  const auto draw = [&](unsigned count) { return static_cast<unsigned>(random() % count); };
  for (int history = 0; history < 300; ++history) {
    HonestArm arm(2);
    ASSERT_TRUE(arm.power_up_and_enable()) << history;
    const double speed = 0.1 * (1 + draw(15)) * (draw(2) == 0 ? 1 : -1);
    arm.move_at(speed);
    const DriveFault fault = kFaults[draw(kFaults.size())];
    arm.drives[1].inject(fault, 0x2310);
    arm.run(draw(5));
    arm.following = false;
    const double before = arm.place(0);
    if (draw(2) == 0) {
      arm.master->disable();
    } else {
      arm.master->quick_stop();
    }
    Watch watch(arm, 1);
    watch.run(draw(200));
    if (draw(2) == 0) arm.drives[1].inject(DriveFault::kNone);
    arm.master->reset_faults();
    watch.run(1000);
    EXPECT_LT(watch.released_at, 2e-3)
        << "history " << history << " speed " << speed << " fault " << static_cast<int>(fault);
    // The way of the ramp, and what the drive had been told when the stop came.
    EXPECT_LT(std::fabs(arm.place(0) - before),
              speed * speed / (2 * kRamp) + 12 * 0.002 * std::fabs(speed) + 1e-3)
        << "history " << history << " fault " << static_cast<int>(fault);
  }
}

}  // namespace
}  // namespace armsig::canopen
