// SPDX-License-Identifier: MIT
// What became of each command that was sent: each has a ticket and a result of its own.
#include "firmware/controller/mover.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "firmware/controller/servo.hpp"
#include "hal/simulated/virtual_clock.hpp"
#include "host_tests/support/puma_cabinet.hpp"
#include "host_tests/support/set_drives.hpp"

namespace armsig::controller {
namespace {

// A tick before drives that a test sets, without torque.
struct Bench {
  Bench() {
    link.models[0] = model_of(configuration.drawing);
    link.models[1] = link.models[0];
    drives.actual = test::puma_configuration();
    tick();
  }
  void tick() {
    servo.tick({});
    clock.wait_until(next += configuration.period);
    mover.refresh();
  }
  Ticket send(CommandKind kind) {
    const auto ticket = mover.send(kind);
    EXPECT_TRUE(ticket);
    return ticket.value_or(0);
  }

  Configuration configuration = test::puma_controller();
  test::SetDrives drives{configuration.drawing.joints.size()};
  simulated::VirtualClock clock;
  Link link;
  Servo servo{configuration, drives, clock, link};
  Mover mover{link};
  hal::Instant next;
};

TEST(Mover, knows_of_each_command_of_one_tick_what_became_of_it) {
  Bench bench;
  const Ticket enable = bench.send(CommandKind::kEnable);
  const Ticket again = bench.send(CommandKind::kEnable);
  const Ticket stop = bench.send(CommandKind::kEndSequence);
  EXPECT_FALSE(bench.mover.is_handled(enable));
  bench.tick();
  ASSERT_TRUE(bench.mover.is_handled(stop));
  EXPECT_EQ(bench.mover.refusal(enable), std::nullopt);
  EXPECT_EQ(bench.mover.refusal(again), Error::kWrongMode);
  EXPECT_EQ(bench.mover.refusal(stop), std::nullopt) << "a refusal of another's is not its own";
}

TEST(Mover, still_knows_a_result_when_the_mailbox_has_been_full_once_more) {
  Bench bench;
  const Ticket refused = bench.send(CommandKind::kReset);
  bench.tick();
  std::vector<Ticket> later;
  while (const auto ticket = bench.mover.send(CommandKind::kEndSequence)) later.push_back(*ticket);
  EXPECT_GE(later.size(), 3U);
  bench.tick();
  EXPECT_EQ(bench.mover.refusal(refused), Error::kWrongMode);
  for (const Ticket ticket : later) EXPECT_EQ(bench.mover.refusal(ticket), std::nullopt);
}

TEST(Mover, takes_no_result_of_a_later_command_for_that_of_one_long_past) {
  Bench bench;
  const Ticket past = bench.send(CommandKind::kEndSequence);
  bench.tick();
  for (std::size_t i = 0; i < Snapshot{}.results.size(); ++i) {
    bench.send(CommandKind::kReset);
    bench.tick();
  }
  EXPECT_TRUE(bench.mover.is_handled(past));
  EXPECT_EQ(bench.mover.refusal(past), std::nullopt);
}

TEST(Mover, says_which_joint_is_furthest_from_where_it_should_be) {
  Bench bench;
  bench.send(CommandKind::kEnable);
  bench.tick();
  bench.drives.set_all(hal::DriveCondition::kEnabled);
  bench.tick();
  bench.drives.actual[4] -= 0.02;
  bench.drives.actual[1] += 0.01;
  bench.tick();
  EXPECT_EQ(bench.mover.furthest_joint(), 4U);
}

}  // namespace
}  // namespace armsig::controller
