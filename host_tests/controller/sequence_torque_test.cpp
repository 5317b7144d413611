// SPDX-License-Identifier: MIT
// A sequence ends where a joint needs more torque than it may: something is in the way.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "host_tests/support/puma_cabinet.hpp"
#include "host_tests/support/servo_bench.hpp"

namespace armsig::controller {
namespace {

using std::chrono::milliseconds;

constexpr double kLimit = 0.8;

struct WatchedCabinet : test::PumaCabinet {
  explicit WatchedCabinet(double limit = kLimit) {
    Configuration configuration = test::puma_controller();
    canopen::Configuration bus = test::puma_bus();
    for (canopen::AxisConfiguration& axis : bus.axes) {
      axis.torque_told = true;
      configuration.supervision.sequence_torque.push_back(limit);
    }
    cabinet::World world = test::puma_world();
    world.drive = test::honest_puma_drive();
    cabinet.reset();
    cabinet =
        std::make_unique<cabinet::VirtualCabinet>(configuration, bus, world, memory, consoles);
  }
  [[nodiscard]] double lag_deg(std::size_t joint) const {
    return degrees(std::abs(now().commanded[joint] - now().positions[joint]));
  }
};

TEST(SequenceTorque, of_a_joint_that_is_blocked_stops_the_arm_long_before_it_lags) {
  WatchedCabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kSweeping));
  const double from = puma.now().positions[0];
  const auto has_moved = [&] { return std::abs(puma.now().positions[0] - from) >= radians(5); };
  for (int i = 0; i < 10'000 && !has_moved(); ++i) puma.cabinet->step();
  ASSERT_TRUE(has_moved()) << puma.ask("status");
  puma.cabinet->inject(0, simulated::DriveFault::kBlocked);
  double lag_deg = 0;
  for (int i = 0; i < 1000 && puma.mode() == Mode::kSweeping; ++i) {
    lag_deg = puma.lag_deg(0);
    puma.cabinet->step();
  }
  ASSERT_TRUE(puma.now().fault);
  EXPECT_EQ(puma.now().fault->error, Error::kTorqueTooLarge);
  EXPECT_EQ(puma.now().fault->joint, 0U);
  std::printf("stopped %.2f degrees behind its target\n", lag_deg);
  EXPECT_LT(lag_deg, 1.5);
  EXPECT_GT(puma.now().largest_torque[0], kLimit);
  EXPECT_NE(puma.ask("status").find(" fault=TORQUE_TOO_LARGE fault_joint=1"), std::string::npos)
      << puma.console.replies.back();
  EXPECT_NE(puma.console.replies.back().find(" largest_torque_percent="), std::string::npos)
      << puma.console.replies.back();
}

TEST(SequenceTorque, of_an_arm_that_nothing_touches_lets_the_sequence_end) {
  WatchedCabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kSweeping));
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 3600));
  double largest = 0;
  for (const double torque : puma.now().largest_torque) largest = std::max(largest, torque);
  std::printf("at most %.0f %%\n", 100 * largest);
  EXPECT_GT(largest, 0.1);
  EXPECT_LT(largest, kLimit);
}

TEST(SequenceTorque, is_no_reason_to_stop_a_move_of_the_operator) {
  WatchedCabinet puma(0.01);
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("move q1_deg=20"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kServoing, 0.1));
  EXPECT_TRUE(puma.run_until(Mode::kHolding, 20));
}

struct TorqueBench : ServoBench {
  TorqueBench() {
    for (std::size_t joint = 0; joint < 6; ++joint) {
      configuration.supervision.sequence_torque.push_back(std::nullopt);
      drives.statuses[joint].torque = 0.1;
    }
    configuration.supervision.sequence_torque[2] = kLimit;
  }
  void begin() {
    hold();
    ASSERT_EQ(send(CommandKind::kBeginSequence), std::nullopt);
  }
  // Ticks of 2 ms until it faults; 100: it does not.
  int ticks_to_fault() {
    int ticks = 0;
    while (ticks < 100 && tick().mode != Mode::kFaulted) ++ticks;
    return ticks;
  }
};

TEST(SequenceTorque, is_a_fault_once_it_has_lasted_20_ms_either_way) {
  for (const double torque : {kLimit + 0.01, -kLimit - 0.01}) {
    TorqueBench bench;
    ASSERT_NO_FATAL_FAILURE(bench.begin());
    bench.drives.statuses[2].torque = torque;
    EXPECT_EQ(bench.ticks_to_fault(), 9);
    bench.expect_fault(Error::kTorqueTooLarge, 2);
    EXPECT_EQ(bench.link.snapshot.read().largest_torque[2], std::abs(torque));
  }
}

TEST(SequenceTorque, that_is_less_for_one_reading_begins_to_last_anew) {
  TorqueBench bench;
  ASSERT_NO_FATAL_FAILURE(bench.begin());
  for (int i = 0; i < 50; ++i) {
    bench.drives.statuses[2].torque = i % 9 == 8 ? kLimit : 3;
    ASSERT_EQ(bench.tick().mode, Mode::kSweeping);
  }
}

TEST(SequenceTorque, is_watched_of_the_joints_that_have_a_limit_and_tell_it) {
  TorqueBench bench;
  ASSERT_NO_FATAL_FAILURE(bench.begin());
  bench.drives.statuses[1].torque = 3;
  bench.drives.statuses[2].torque.reset();
  EXPECT_EQ(bench.ticks_to_fault(), 100);
}

TEST(SequenceTorque, is_watched_while_a_sequence_runs_alone_and_remembered_of_the_last) {
  TorqueBench bench;
  ASSERT_NO_FATAL_FAILURE(bench.begin());
  bench.drives.statuses[2].torque = 0.5;
  bench.tick();
  ASSERT_EQ(bench.send(CommandKind::kEndSequence), std::nullopt);
  bench.drives.statuses[2].torque = 3;
  EXPECT_EQ(bench.ticks_to_fault(), 100);
  EXPECT_EQ(bench.link.snapshot.read().largest_torque[2], 0.5);
  bench.drives.statuses[2].torque = 0.2;
  ASSERT_EQ(bench.send(CommandKind::kBeginSequence), std::nullopt);
  bench.tick();
  EXPECT_EQ(bench.link.snapshot.read().largest_torque[2], 0.2);
}

}  // namespace
}  // namespace armsig::controller
