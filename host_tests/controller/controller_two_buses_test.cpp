// SPDX-License-Identifier: MIT
// The whole controller about six drives on two buses, at 1 kHz.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "host_tests/support/puma_cabinet.hpp"
#include "host_tests/support/puma_drives.hpp"

namespace armsig::controller {
namespace {

using std::chrono::milliseconds;
using test::PumaCabinet;

struct TwoBusCabinet : PumaCabinet {
  explicit TwoBusCabinet(bool is_late = false) {
    Configuration configuration = test::puma_controller();
    configuration.period = milliseconds(1);
    canopen::Configuration bus = test::puma_bus();
    test::put_on_two_buses(bus);
    cabinet::World world = test::puma_world();
    world.drive = test::honest_puma_drive();
    cabinet.reset();
    cabinet =
        std::make_unique<cabinet::VirtualCabinet>(configuration, bus, world, memory, consoles);
    if (is_late) cabinet->master_port(1).set_up(false);
  }
  void begin_to_move() {
    ASSERT_TRUE(enable());
    ASSERT_EQ(ask("move q1_deg=60 q4_deg=90"), "ok");
    run(1);
    ASSERT_EQ(mode(), Mode::kServoing);
  }
  [[nodiscard]] bool told(const std::string& words) const {
    return std::ranges::any_of(console.told, [&](const std::string& line) {
      return line.find(words) != std::string::npos;
    });
  }
  void expect_all_stopped() {
    run(2);
    for (std::size_t joint = 0; joint < 6; ++joint) {
      EXPECT_LT(std::fabs(cabinet->drive(joint).velocity()), 1) << joint;
      EXPECT_NE(cabinet->drive(joint).state(), cia402::State::kOperationEnabled) << joint;
    }
  }
};

TEST(ControllerTwoBuses, sets_up_and_moves_joints_of_both) {
  TwoBusCabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("move q1_deg=20 q4_deg=50"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kServoing, 0.1));
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 20));
  puma.run(1);
  EXPECT_NEAR(puma.now().positions[0], radians(20), 1e-3);
  EXPECT_NEAR(puma.now().positions[3], radians(50), 1e-3);
}

TEST(ControllerTwoBuses, stops_every_joint_when_either_fails_and_names_it) {
  for (const std::size_t failed : {0U, 1U}) {
    for (const bool off : {false, true}) {
      TwoBusCabinet puma;
      puma.begin_to_move();
      if (off) puma.cabinet->master_port(failed).go_bus_off();
      if (!off) puma.cabinet->master_port(failed).set_up(false);
      ASSERT_TRUE(puma.run_until(Mode::kFaulted, 0.1));
      const std::string error = off ? "BUS_OFF" : "BUS_DOWN";
      const std::string name = failed == 0 ? "can" : "can2";
      EXPECT_NE(puma.ask("status").find(" fault=" + error + " fault_joint=" +
                                        (failed == 0 ? "1" : "4") + " fault_says=\"" + name + "\""),
                std::string::npos)
          << puma.console.replies.back();
      EXPECT_TRUE(puma.told("# mode faulted error=" + error));
      EXPECT_TRUE(puma.told(" says=\"" + name + "\""));
      puma.expect_all_stopped();
      puma.cabinet->master_port(failed).set_up(true);
      puma.run(1);
      EXPECT_EQ(puma.ask("reset"), "ok");
      EXPECT_TRUE(puma.run_until(Mode::kIdle, 20));
      puma.confirm();
      EXPECT_TRUE(puma.enable());
    }
  }
}

TEST(ControllerTwoBuses, waits_for_an_interface_that_is_late_and_names_it) {
  TwoBusCabinet puma(true);
  puma.run(4);
  EXPECT_EQ(puma.mode(), Mode::kStarting);
  EXPECT_NE(puma.ask("status").find(" fault=BUS_DOWN fault_says=\"can2\""), std::string::npos)
      << puma.console.replies.back();
  puma.cabinet->master_port(1).set_up(true);
  EXPECT_TRUE(puma.enable());
}

TEST(ControllerTwoBuses, tells_a_fault_of_a_drive_from_that_of_its_namesake) {
  TwoBusCabinet puma;
  puma.begin_to_move();
  puma.cabinet->inject(3, simulated::DriveFault::kSilent);
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 0.1));
  EXPECT_EQ(puma.now().fault->joint, 3U);
  puma.run(1);
  EXPECT_EQ(puma.cabinet->drive(0).state(), cia402::State::kQuickStopActive);
}

}  // namespace
}  // namespace armsig::controller
