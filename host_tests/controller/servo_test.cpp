// SPDX-License-Identifier: MIT
// When the servo tick gives torque, how far a move is at each tick, how a halt ends it, and what it
// publishes.
#include <chrono>
#include <vector>

#include <gtest/gtest.h>

#include "host_tests/support/servo_bench.hpp"

namespace armsig::controller {
namespace {

using Bench = ServoBench;
using std::chrono::milliseconds;
using enum hal::DriveCondition;

TEST(ServoEnabling, is_refused_until_every_drive_is_without_torque_and_twice) {
  Bench bench;
  bench.tick();
  bench.drives.statuses[5].condition = kStopping;
  EXPECT_EQ(bench.send(CommandKind::kEnable), Error::kWrongMode);
  EXPECT_EQ(bench.drives.enabled, 0);
  bench.drives.set_all(kDisabled);
  bench.drives.on_enable = Error::kDrivesNotReady;
  EXPECT_EQ(bench.send(CommandKind::kEnable), Error::kDrivesNotReady);
  bench.drives.on_enable.reset();
  EXPECT_EQ(bench.send(CommandKind::kEnable), std::nullopt);
  EXPECT_EQ(bench.send(CommandKind::kEnable), Error::kWrongMode) << "under way already";
  EXPECT_EQ(bench.drives.enabled, 2);
  for (std::size_t joint = 0; joint < 5; ++joint) bench.drives.statuses[joint].condition = kEnabled;
  EXPECT_EQ(bench.tick().mode, Mode::kIdle) << "the last one has no torque";
  bench.drives.statuses[5].condition = kEnabled;
  EXPECT_EQ(bench.tick().mode, Mode::kHolding);
}

TEST(ServoEnabling, holds_the_joints_that_have_torque_and_follows_the_others) {
  Bench bench;
  bench.tick();
  const double held = bench.drives.actual[0];
  ASSERT_EQ(bench.send(CommandKind::kEnable), std::nullopt);
  bench.drives.statuses[0].has_torque = true;
  bench.drives.actual[0] += 1e-3;
  bench.drives.actual[1] += 1e-3;
  bench.tick();
  EXPECT_EQ(bench.drives.targets[0], held);
  EXPECT_EQ(bench.drives.targets[1], bench.drives.actual[1]);
  bench.drives.actual[0] += 0.06;
  bench.tick();
  bench.expect_fault(Error::kFollowingError, 0);
}

TEST(ServoDisabling, takes_the_torque_off_and_ends_move_and_sequence) {
  Bench bench;
  EXPECT_EQ(bench.send(CommandKind::kDisable), Error::kWrongMode) << "before the drives are found";
  bench.drives.set_all(kStarting);
  EXPECT_EQ(bench.drives.disabled, 0);
  bench.drives.set_all(kDisabled);
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  ASSERT_EQ(bench.send(CommandKind::kBeginSequence), std::nullopt);
  ASSERT_EQ(bench.send(bench.move_by(0, 0.5)), std::nullopt);
  bench.follow();
  EXPECT_EQ(bench.send(CommandKind::kDisable), std::nullopt);
  EXPECT_EQ(bench.drives.disabled, 1);
  EXPECT_EQ(bench.link.snapshot.read().mode, Mode::kIdle);
  EXPECT_FALSE(bench.link.snapshot.read().moving);
  bench.drives.set_all(kDisabled);
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  EXPECT_EQ(bench.link.snapshot.read().mode, Mode::kHolding) << "no sequence is left over";
}

// Half of a minimum-jerk move is reached after half of its time, to the tick.
TEST(ServoMoves, are_where_their_course_is_at_each_tick) {
  Bench bench;
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  const Command command = bench.move_by(1, 1.0);
  const double duration_s = command.move.duration_s;
  EXPECT_NEAR(duration_s, 1.875 * 1.0 / 1.0, 1e-12) << "the speed limit is what counts";
  ASSERT_EQ(bench.send(command), std::nullopt);
  for (int k = 2; k < 900; ++k) {
    const Snapshot& now = bench.follow();
    const double part = k * 0.002 / duration_s;
    ASSERT_NEAR(now.commanded[1] - command.move.from[1], minimum_jerk(part), 1e-12) << k;
    ASSERT_NEAR(now.left_s, duration_s - k * 0.002, 1e-12);
    ASSERT_TRUE(now.moving);
    ASSERT_EQ(now.mode, Mode::kServoing);
  }
  for (int k = 900; k <= 938; ++k) bench.follow();
  EXPECT_FALSE(bench.link.snapshot.read().moving);
  EXPECT_EQ(bench.link.snapshot.read().mode, Mode::kHolding);
  EXPECT_EQ(bench.link.snapshot.read().left_s, 0);
  EXPECT_NEAR(bench.drives.targets[1], command.move.to[1], 1e-15);
}

TEST(ServoMoves, begin_where_the_arm_is_commanded_to_be_and_one_at_a_time) {
  Bench bench;
  bench.tick();
  EXPECT_EQ(bench.send(bench.move_by(0, 0.1)), Error::kWrongMode) << "without torque";
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  for (std::size_t joint = 0; joint < 6; ++joint) {
    Command elsewhere = bench.move_by(0, 0.1);
    elsewhere.move.from[joint] += 2e-9;
    EXPECT_EQ(bench.send(elsewhere), Error::kWrongMode) << joint;
    elsewhere.move.from[joint] -= 4e-9;
    EXPECT_EQ(bench.send(elsewhere), Error::kWrongMode) << joint;
  }
  EXPECT_EQ(bench.send(bench.move_by(0, 0.1)), std::nullopt);
  EXPECT_EQ(bench.send(bench.move_by(0, 0.1)), Error::kWrongMode) << "one is under way";
  Command adopt;
  adopt.kind = CommandKind::kAdoptModel;
  adopt.index = 1;
  EXPECT_EQ(bench.send(adopt), Error::kWrongMode);
  EXPECT_EQ(bench.link.snapshot.read().model, 0U);
}

TEST(ServoMoves, of_a_sequence_leave_its_mode_and_end_with_it) {
  Bench bench;
  bench.tick();
  EXPECT_EQ(bench.send(CommandKind::kBeginSequence), Error::kWrongMode);
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  ASSERT_EQ(bench.send(CommandKind::kBeginSequence), std::nullopt);
  EXPECT_EQ(bench.link.snapshot.read().mode, Mode::kSweeping);
  EXPECT_EQ(bench.send(CommandKind::kBeginSequence), Error::kWrongMode);
  ASSERT_EQ(bench.send(bench.move_by(0, 0.1)), std::nullopt);
  EXPECT_EQ(bench.follow().mode, Mode::kSweeping);
  EXPECT_EQ(bench.send(CommandKind::kEndSequence), std::nullopt);
  EXPECT_EQ(bench.link.snapshot.read().mode, Mode::kServoing) << "the move is finished";
}

// Where a move of 1 rad in 1.875 s has come to 0.5 rad/s it speeds up by 1.633 rad/s2, and jerk is
// at most 27/8 * 3^2 / 1 = 30.4 rad/s3: that is gone after 54 ms, at 0.544 rad/s. The ramp of 3
// rad/s2 then takes 0.544 / 3 s, and 3 / 30.4 s until the deceleration has come and gone.
TEST(ServoHalt, ends_a_move_by_the_ramp_of_the_joint_that_has_least_left) {
  Bench bench;
  EXPECT_EQ(bench.send(CommandKind::kHalt), Error::kWrongMode);
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  EXPECT_EQ(bench.send(CommandKind::kHalt), std::nullopt) << "at rest there is nothing to do";
  ASSERT_EQ(bench.send(bench.move_by(2, -1.0)), std::nullopt);
  double speed = 0;
  double before = bench.drives.targets[2];
  while (speed < 0.5) {
    bench.follow();
    speed = (before - bench.drives.targets[2]) / 0.002;
    before = bench.drives.targets[2];
  }
  EXPECT_EQ(bench.send(CommandKind::kHalt), std::nullopt);
  int ticks = 1;
  while (bench.link.snapshot.read().moving && ticks < 1000) {
    bench.follow();
    ++ticks;
  }
  EXPECT_NEAR(ticks * 0.002, 0.0537 + 0.544 / 3 + 3 / 30.375, 0.006);
  EXPECT_EQ(bench.follow().mode, Mode::kHolding);
}

TEST(ServoHalt, said_again_while_it_brakes_changes_nothing) {
  Bench once;
  Bench twice;
  for (Bench* bench : {&once, &twice}) {
    ASSERT_NO_FATAL_FAILURE(bench->hold());
    ASSERT_EQ(bench->send(bench->move_by(2, -1.0)), std::nullopt);
    for (int i = 0; i < 400; ++i) bench->follow();
    ASSERT_EQ(bench->send(CommandKind::kHalt), std::nullopt);
    for (int i = 0; i < 60; ++i) bench->follow();
    ASSERT_TRUE(bench->link.snapshot.read().moving);
  }
  once.tick();
  ASSERT_EQ(twice.send(CommandKind::kHalt), std::nullopt);
  for (int i = 0; i < 200; ++i) {
    once.follow();
    twice.follow();
    ASSERT_EQ(twice.drives.targets[2], once.drives.targets[2]) << i;
  }
  EXPECT_FALSE(twice.link.snapshot.read().moving);
}

// The background may send the next move of a sequence before it has seen that the tick took a halt.
TEST(ServoHalt, leaves_a_sequence_no_further_move) {
  Bench bench;
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  ASSERT_EQ(bench.send(CommandKind::kBeginSequence), std::nullopt);
  Command next = bench.move_by(1, 0.4);
  next.of_sequence = true;
  Command halt;
  halt.kind = CommandKind::kHalt;
  halt.serial = ++bench.serial;
  ASSERT_TRUE(bench.link.commands.post(halt));
  EXPECT_EQ(bench.send(next), Error::kWrongMode);
  EXPECT_FALSE(bench.link.snapshot.read().moving);
  EXPECT_EQ(bench.link.snapshot.read().mode, Mode::kHolding);
}

TEST(ServoPublishes, how_long_the_arm_has_stood_within_the_tolerance) {
  Bench bench;
  ASSERT_NO_FATAL_FAILURE(bench.hold());
  EXPECT_EQ(bench.link.snapshot.read().settled, hal::Duration::zero());
  for (int i = 0; i < 10; ++i) bench.tick();
  EXPECT_EQ(bench.link.snapshot.read().settled, milliseconds(20));
  bench.drives.actual[5] -= 0.99e-4;
  EXPECT_EQ(bench.tick().settled, milliseconds(22)) << "within 1e-4";
  bench.drives.actual[5] -= 0.02e-4;
  EXPECT_EQ(bench.tick().settled, hal::Duration::zero());
  bench.drives.actual[5] += 0.1e-4;
  EXPECT_EQ(bench.tick().settled, milliseconds(2));
  ASSERT_EQ(bench.send(bench.move_by(0, 1e-7)), std::nullopt);
  EXPECT_EQ(bench.tick().settled, hal::Duration::zero()) << "while it moves";
  EXPECT_EQ(bench.send(CommandKind::kDisable), std::nullopt);
  bench.tick();
  EXPECT_EQ(bench.tick().settled, hal::Duration::zero()) << "without torque";
}

TEST(ServoPublishes, that_the_arm_does_not_stand_where_any_joint_is_off_its_place) {
  for (std::size_t joint = 0; joint < 6; ++joint) {
    Bench bench;
    ASSERT_NO_FATAL_FAILURE(bench.hold());
    ASSERT_GT(bench.tick().settled, hal::Duration::zero());
    bench.drives.actual[joint] += 1.1e-4;
    EXPECT_EQ(bench.tick().settled, hal::Duration::zero()) << joint;
  }
}

TEST(ServoPublishes, each_tick_to_who_looks_on) {
  class Ticks final : public TickObserver {
   public:
    std::vector<hal::Duration> lateness;

   private:
    void do_take(const Snapshot& snapshot, hal::Duration late) override {
      EXPECT_EQ(snapshot.lateness.total, lateness.size() + 1);
      lateness.push_back(late);
    }
  } ticks;
  Bench bench;
  bench.link.observer = &ticks;
  bench.tick();
  bench.tick(milliseconds(1));
  EXPECT_EQ(ticks.lateness, (std::vector<hal::Duration>{{}, milliseconds(1)}));
}

TEST(ServoPublishes, what_the_drives_say_joint_by_joint) {
  Bench bench;
  bench.drives.statuses[0].status_word = 0x0001;
  bench.drives.statuses[5].status_word = 0x0F50;
  bench.drives.statuses[2].limit_active = true;
  bench.drives.statuses[5].limit_active = true;
  const Snapshot& now = bench.tick();
  EXPECT_EQ(now.status_words.size(), 6U);
  EXPECT_EQ(now.status_words[0], 0x0001);
  EXPECT_EQ(now.status_words[5], 0x0F50);
  EXPECT_EQ(now.limits_active, 0b100100);
  EXPECT_TRUE(now.all_disabled);
  bench.drives.statuses[3].condition = kSwitching;
  EXPECT_FALSE(bench.tick().all_disabled);
  EXPECT_LT(
      (bench.link.snapshot.read().X_RT->p - tool_pose(bench.link.models[0], bench.drives.actual)->p)
          .norm(),
      1e-15);
}

TEST(ServoPublishes, lateness_of_every_tick) {
  Bench bench;
  bench.tick(std::chrono::microseconds(3));
  bench.tick(std::chrono::microseconds(100));
  const Histogram lateness = bench.tick(std::chrono::microseconds(2)).lateness;
  EXPECT_EQ(lateness.total, 3U);
  EXPECT_EQ(lateness.largest, std::chrono::microseconds(100));
  EXPECT_NEAR(lateness.mean_us(), 35, 1e-9);
  EXPECT_EQ(lateness.counts[2], 2U) << "2 and 3 us";
  EXPECT_EQ(lateness.counts[7], 1U) << "64 to 127 us";
}

TEST(Histogram, counts_nothing_long_and_negative_in_its_first_and_last_bin) {
  Histogram histogram;
  EXPECT_EQ(histogram.mean_us(), 0);
  histogram.add(std::chrono::nanoseconds(999));
  histogram.add(std::chrono::nanoseconds(-5000));
  histogram.add(std::chrono::hours(1));
  EXPECT_EQ(histogram.counts.front(), 2U);
  EXPECT_EQ(histogram.counts.back(), 1U);
  EXPECT_EQ(histogram.total, 3U);
}

}  // namespace
}  // namespace armsig::controller
