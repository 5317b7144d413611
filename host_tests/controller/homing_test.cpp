// SPDX-License-Identifier: MIT
// A cabinet whose drives count from zero at every power-up: `home`, and what is refused until then.
#include <algorithm>

#include <gtest/gtest.h>

#include "host_tests/support/homing_puma.hpp"

namespace armsig::controller {
namespace {

struct Cabinet : test::PumaCabinet {
  explicit Cabinet(const simulated::DriveConfiguration& drive = test::homing_puma_drive(),
                   const Configuration& configuration = test::homing_puma_controller())
      : PumaCabinet(1, configuration, drive) {}
  [[nodiscard]] bool told(std::string_view begins) const {
    return std::ranges::any_of(console.told,
                               [&](const std::string& line) { return line.starts_with(begins); });
  }
  [[nodiscard]] bool is_unreferenced(std::size_t joint) const {
    return (cabinet->state().unreferenced() >> joint & 1U) != 0;
  }
};

TEST(HomedJoints, are_unreferenced_after_every_start_and_told_what_to_do) {
  Cabinet puma;
  ASSERT_TRUE(puma.enable());
  EXPECT_TRUE(puma.is_unreferenced(1));
  EXPECT_TRUE(puma.told("# unreferenced joint=2 why=counts_from_power_up "));
  EXPECT_TRUE(std::ranges::any_of(
      puma.console.told, [](const std::string& line) { return line.ends_with(" home joint=2"); }));
}

TEST(HomedJoints, are_referenced_once_their_drive_has_found_its_reference) {
  Cabinet puma;
  ASSERT_TRUE(puma.enable());
  const JointVector before = puma.now().positions;
  EXPECT_NEAR(degrees(before[1]), 0, 0.01) << "and stands at -90";
  ASSERT_EQ(puma.ask("home joint=2"), "ok");
  ASSERT_EQ(puma.mode(), Mode::kHoming);
  EXPECT_NE(puma.ask("status").find(" mode=homing "), std::string::npos);
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 30));
  puma.run(0.1);
  EXPECT_TRUE(puma.told("# homed joint=2"));
  EXPECT_FALSE(puma.is_unreferenced(1));
  EXPECT_TRUE(puma.is_unreferenced(2));
  const double true_deg = degrees(puma.cabinet->sensor().true_readings()[1]);
  EXPECT_NEAR(degrees(puma.now().positions[1]), true_deg, 0.002) << "half of the play, and a count";
  EXPECT_NEAR(true_deg, -88, 0.1);
  EXPECT_NEAR(puma.now().positions[0], before[0], 1e-4);
}

TEST(HomedJoints, are_moved_from_where_they_are_then) {
  Cabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("home joint=2"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 30));
  puma.run(0.1);
  ASSERT_EQ(puma.ask("move dq2_deg=5 pace=0.1"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kServoing, 1) && puma.run_until(Mode::kHolding, 30));
  puma.run(0.5);
  EXPECT_NEAR(degrees(puma.cabinet->sensor().true_readings()[1]), -83, 0.1);
}

TEST(HomedJoints, keep_the_others_from_moving_until_the_search_is_over) {
  Cabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("home joint=2"), "ok");
  puma.run(0.1);
  EXPECT_TRUE(puma.ask("move dq1_deg=1 pace=0.1").starts_with("error WRONG_MODE"));
  EXPECT_TRUE(puma.ask("home joint=3").starts_with("error WRONG_MODE"));
}

TEST(HomedJoints, stop_on_halt_with_torque_and_without_a_reference) {
  Cabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("home joint=2"), "ok");
  puma.run(0.5);
  ASSERT_EQ(puma.ask("halt"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 3));
  puma.run(0.1);
  EXPECT_TRUE(puma.is_unreferenced(1));
  EXPECT_FALSE(puma.told("# homed"));
  EXPECT_EQ(puma.ask("home joint=2"), "ok") << "again";
  EXPECT_TRUE(puma.run_until(Mode::kHolding, 30));
  puma.run(0.1);
  EXPECT_FALSE(puma.is_unreferenced(1));
}

TEST(HomedJoints, end_their_search_by_disable_and_by_stop) {
  for (const auto& [verb, ends] : {std::pair{"disable", Mode::kIdle}, {"stop", Mode::kFaulted}}) {
    Cabinet puma;
    ASSERT_TRUE(puma.enable());
    ASSERT_EQ(puma.ask("home joint=2"), "ok");
    puma.run(0.5);
    ASSERT_EQ(puma.ask(verb), "ok");
    EXPECT_EQ(puma.mode(), ends);
    puma.run(2);
    const double stopped = puma.cabinet->drive(1).position();
    puma.run(1);
    EXPECT_NEAR(puma.cabinet->drive(1).position(), stopped, 5) << verb;
    if (ends == Mode::kFaulted) EXPECT_EQ(puma.ask("reset"), "ok");
    EXPECT_TRUE(puma.enable()) << verb;
    EXPECT_TRUE(puma.is_unreferenced(1)) << verb;
  }
}

TEST(HomedJoints, without_a_switch_fault_the_arm) {
  auto drive = test::homing_puma_drive();
  drive.home_switch.reset();
  Cabinet puma(drive);
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("home joint=2"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 3));
  const std::string status = puma.ask("status");
  EXPECT_NE(status.find(" fault=HOMING_FAILED fault_joint=2 "), std::string::npos) << status;
  EXPECT_TRUE(puma.is_unreferenced(1));
}

TEST(HomedJoints, are_still_known_after_a_reset_that_leaves_their_drives_as_they_are) {
  Cabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("home joint=2"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 30));
  ASSERT_EQ(puma.ask("stop"), "ok");
  puma.run(1);
  ASSERT_EQ(puma.ask("reset"), "ok");
  ASSERT_TRUE(puma.enable());
  EXPECT_FALSE(puma.is_unreferenced(1));
  EXPECT_TRUE(puma.is_unreferenced(2)) << "it has not homed";
  puma.cabinet->drive(1).inject(simulated::DriveFault::kReboot);
  puma.run(0.5);
  ASSERT_EQ(puma.ask("reset"), "ok");
  ASSERT_TRUE(puma.enable());
  EXPECT_TRUE(puma.is_unreferenced(1)) << "its drive was set up anew";
}

TEST(HomedJoints, are_known_no_more_after_the_next_power_up) {
  Cabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("home joint=2"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 30));
  ASSERT_EQ(puma.ask("disable"), "ok");
  puma.run(3);
  EXPECT_FALSE(puma.is_unreferenced(1));
  puma.start(test::homing_puma_controller(), 1);
  ASSERT_TRUE(puma.enable());
  EXPECT_TRUE(puma.is_unreferenced(1));
}

TEST(HomedJoints, are_those_alone_that_the_configuration_names) {
  Cabinet puma;
  ASSERT_TRUE(puma.enable());
  EXPECT_EQ(puma.ask("home joint=1"),
            "error UNSUPPORTED this kind of arm or request is not supported joint=1 why=\"its "
            "configuration does not say reference: homed\"");
  for (const char* bad : {"home joint=0", "home joint=7", "home joint=1.5"}) {
    EXPECT_TRUE(puma.ask(bad).starts_with("error OUT_OF_RANGE ")) << bad;
  }
  for (const char* bad : {"home", "home joint=two", "home q2_deg=1", "home joint=2 joint=3"}) {
    EXPECT_TRUE(puma.ask(bad).starts_with("error UNKNOWN_REQUEST ")) << bad;
  }
  EXPECT_EQ(puma.mode(), Mode::kHolding);
}

TEST(HomedJoints, of_any_configuration_home_in_the_virtual_cabinet) {
  cabinet::World world = test::puma_world();
  world.start[1] = radians(-20);
  test::RamMemory memory;
  test::LineConsole console;
  const std::array<hal::Console*, 1> consoles{&console};
  cabinet::VirtualCabinet puma(test::homing_puma_controller(), test::puma_bus(), world, memory,
                               consoles);
  const auto run_until = [&](Mode mode) {
    for (int i = 0; i < 10'000 && puma.state().snapshot().mode != mode; ++i) puma.step();
    return puma.state().snapshot().mode == mode;
  };
  ASSERT_TRUE(run_until(Mode::kIdle));
  console.requests.emplace_back("enable");
  ASSERT_TRUE(run_until(Mode::kHolding));
  EXPECT_NEAR(puma.state().snapshot().positions[1], 0, 1e-4);
  console.requests.emplace_back("home joint=2");
  ASSERT_TRUE(run_until(Mode::kHoming) && run_until(Mode::kHolding));
  const double true_rad = puma.sensor().true_readings()[1];
  EXPECT_NEAR(puma.state().snapshot().positions[1], true_rad, 1e-4);
  EXPECT_NEAR(true_rad, 0, 1e-3);
}

TEST(HomedJoints, are_not_those_whose_motor_moves_another_joint_too) {
  Configuration wrist = test::homing_puma_controller();
  wrist.drawing.couplings.push_back({.joint = 4, .from = 3, .ratio = 0.1});
  Cabinet puma(test::homing_puma_drive(), wrist);
  ASSERT_TRUE(puma.enable());
  for (const char* joint : {"home joint=4", "home joint=5"}) {
    const std::string reply = puma.ask(joint);
    EXPECT_TRUE(reply.starts_with("error UNSUPPORTED ")) << reply;
    EXPECT_NE(reply.find("its motor moves another joint, too"), std::string::npos) << reply;
  }
  EXPECT_EQ(puma.ask("home joint=3"), "ok");
}

}  // namespace
}  // namespace armsig::controller
