// SPDX-License-Identifier: MIT
// The whole controller about drives that move two joints each.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "host_tests/support/puma_cabinet.hpp"
#include "host_tests/support/table_3_run.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

struct DualCabinet : PumaCabinet {
  explicit DualCabinet(canopen::Configuration bus = test::puma_bus_of_dual_drives()) { begin(bus); }
  void begin(const canopen::Configuration& bus) {
    cabinet::World world = test::puma_world();
    world.drive = test::honest_puma_drive();
    cabinet.reset();
    cabinet = std::make_unique<cabinet::VirtualCabinet>(test::puma_controller(), bus, world, memory,
                                                        consoles);
  }
};

// Nodes of two axes, and two drives of their own.
canopen::Configuration two_dual_drives() {
  canopen::Configuration bus = test::puma_bus_of_dual_drives();
  bus.axes[4].node = 5;
  bus.axes[4].axis = 1;
  bus.axes[5].node = 6;
  bus.axes[5].axis = 1;
  return bus;
}

TEST(ControllerDualAxis, identifies_and_accepts_as_with_a_drive_a_joint) {
  DualCabinet puma(two_dual_drives());
  ASSERT_TRUE(test::identify_and_accept(puma)) << puma.console.replies.back();
  EXPECT_TRUE(puma.cabinet->state().active());
}

TEST(ControllerDualAxis, stops_the_arm_when_one_axis_faults) {
  DualCabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("move q1_deg=30"), "ok");
  puma.run(0.5);
  puma.cabinet->inject(3, simulated::DriveFault::kEmergency, 0x2310);
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 1));
  puma.run(1);
  const std::string status = puma.ask("status");
  EXPECT_NE(status.find("DRIVE_EMERGENCY"), std::string::npos) << status;
  for (const std::size_t joint : {0U, 1U, 2U, 4U, 5U}) {
    EXPECT_EQ(puma.cabinet->drive(joint).state(), cia402::State::kQuickStopActive) << joint;
    EXPECT_LT(std::fabs(puma.cabinet->drive(joint).velocity()), 1) << joint;
  }
}

TEST(ControllerDualAxis, is_rehearsed_with_faults_of_a_whole_node) {
  DualCabinet puma;
  ASSERT_TRUE(puma.enable());
  puma.cabinet->inject(2, simulated::DriveFault::kSilent);
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 1));
  puma.run(0.5);
  for (const char* joint : {" joint=3", " joint=4"}) {
    EXPECT_TRUE(std::ranges::any_of(puma.console.told, [&](const std::string& line) {
      return line.find("faulted") != std::string::npos && line.find(joint) != std::string::npos;
    })) << joint;
  }
  puma.cabinet->inject(3, simulated::DriveFault::kNone);
  ASSERT_EQ(puma.ask("reset"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kIdle, 10));
}

// Both axes of a drive have one serial number: a signature is of the axis too.
TEST(ControllerDualAxis, does_not_take_the_signature_of_exchanged_axes) {
  DualCabinet puma;
  ASSERT_TRUE(test::identify_and_accept(puma)) << puma.console.replies.back();
  canopen::Configuration exchanged = test::puma_bus_of_dual_drives();
  std::swap(exchanged.axes[0].axis, exchanged.axes[1].axis);
  puma.begin(exchanged);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.run(0.5);
  EXPECT_NE(puma.cabinet->state().unreferenced() & 3U, 0U);
}

}  // namespace
}  // namespace armsig::controller
