// SPDX-License-Identifier: MIT
// The servo tick alone, before drives that a test sets.
#pragma once

#include <optional>

#include <gtest/gtest.h>

#include "firmware/controller/servo.hpp"
#include "hal/simulated/virtual_clock.hpp"
#include "host_tests/support/puma_cabinet.hpp"
#include "host_tests/support/set_drives.hpp"

namespace armsig::controller {

struct ServoBench {
  ServoBench() {
    link.models[0] = model_of(configuration.drawing);
    link.models[1] = link.models[0];
    drives.actual = test::puma_configuration();
  }
  const Snapshot& tick(hal::Duration lateness = {}) {
    servo.tick(lateness);
    clock.wait_until(next += configuration.period);
    return link.snapshot.read();
  }
  // What the tick said to a command.
  std::optional<Error> send(Command command) {
    command.serial = ++serial;
    EXPECT_TRUE(link.commands.post(command));
    const Snapshot& out = tick();
    EXPECT_EQ(out.handled, serial);
    EXPECT_EQ(out.results[serial % out.results.size()].serial, serial);
    return out.results[serial % out.results.size()].refused;
  }
  std::optional<Error> send(CommandKind kind) {
    Command command;
    command.kind = kind;
    return send(command);
  }
  // Every drive has torque and holds where it is.
  void hold() {
    tick();
    ASSERT_EQ(send(CommandKind::kEnable), std::nullopt);
    drives.set_all(hal::DriveCondition::kEnabled);
    ASSERT_EQ(tick().mode, Mode::kHolding);
  }
  Command move_by(std::size_t joint, double way) {
    JointVector to = link.snapshot.read().commanded;
    to[joint] += way;
    Command command;
    command.kind = CommandKind::kMove;
    command.move = *plan_joint_move(configuration, link.snapshot.read().commanded, to);
    return command;
  }
  // A tick of drives that are where they were told to be.
  const Snapshot& follow() {
    drives.actual = drives.targets;
    return tick();
  }
  void expect_fault(Error error, std::optional<std::size_t> joint) {
    const Snapshot& now = link.snapshot.read();
    ASSERT_EQ(now.mode, Mode::kFaulted);
    ASSERT_TRUE(now.fault);
    EXPECT_EQ(now.fault->error, error);
    EXPECT_EQ(now.fault->joint, joint);
    EXPECT_EQ(drives.quick_stops, 1);
  }

  Configuration configuration = test::puma_controller();
  test::SetDrives drives{configuration.drawing.joints.size()};
  simulated::VirtualClock clock;
  Link link;
  Servo servo{configuration, drives, clock, link};
  hal::Instant next;
  std::uint32_t serial = 0;
};

}  // namespace armsig::controller
