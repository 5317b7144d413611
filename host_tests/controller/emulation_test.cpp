// SPDX-License-Identifier: MIT
// `emulate`: faults of the emulated world, asked for at the console of a virtual controller.
#include <gtest/gtest.h>

#include "firmware/virtual_cabinet/emulation_console.hpp"
#include "hal/simulated/drive_fault.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

// A cabinet whose console is behind the emulation's.
struct EmulatedPuma : PumaCabinet {
  EmulatedPuma() {
    outer[0] = &emulation;
    cabinet.reset();
    cabinet::World world = test::puma_world();
    world.drive = drives;
    world.sockets.ball_F = {0.15, 0, 0.05};
    world.sockets.all.push_back({.place = {'A', '1'}, .p_0 = {0.4, 0.2, 0.1}});
    world.sockets.all.push_back({.place = {'F'}, .p_0 = {9, 0, 0}});
    cabinet = std::make_unique<cabinet::VirtualCabinet>(test::puma_controller(), test::puma_bus(),
                                                        world, memory, outer);
    emulation.attend(*cabinet);
  }
  void expect_refused(const std::string& request, const std::string& words) {
    const std::string reply = ask(request);
    EXPECT_TRUE(reply.starts_with("error ")) << reply;
    EXPECT_NE(reply.find(words), std::string::npos) << reply;
  }

  cabinet::EmulationConsole emulation{console};
  std::array<hal::Console*, 1> outer{};
};

TEST(Emulation, of_a_drives_fault_ends_in_the_controllers_fault_and_can_be_ended) {
  EmulatedPuma puma;
  ASSERT_TRUE(puma.enable());
  EXPECT_EQ(puma.ask("emulate joint=3 fault=emergency code=9040"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 0.1));
  EXPECT_EQ(puma.now().fault->joint, 2U);
  EXPECT_EQ(puma.now().fault->code, 0x2350U);
  EXPECT_EQ(puma.ask("emulate joint=3 fault=none"), "ok");
  EXPECT_EQ(puma.ask("reset"), "ok");
  EXPECT_TRUE(puma.enable());
}

TEST(Emulation, knows_every_fault_of_a_drive_by_name) {
  for (const char* name : {"none", "emergency", "silent", "heartbeat", "feedback", "blocked",
                           "power", "reboot", "deaf", "jump", "pre-operational", "sdo", "sync",
                           "ignores", "bits-clear", "bits-set", "information"}) {
    EXPECT_TRUE(simulated::drive_fault(name)) << name;
  }
  EXPECT_EQ(simulated::drive_fault("blocked"), simulated::DriveFault::kBlocked);
  EXPECT_FALSE(simulated::drive_fault("Blocked"));
}

TEST(Emulation, leans_on_a_joint_by_the_angle_that_was_asked_for) {
  EmulatedPuma puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  const double before = puma.now().positions[1];
  EXPECT_EQ(puma.ask("emulate joint=2 push_deg=-3"), "ok");
  puma.run(0.1);
  EXPECT_NEAR(degrees(puma.now().positions[1] - before), -3, 0.01);
}

TEST(Emulation, of_the_sensor_and_the_air_reaches_the_controller) {
  EmulatedPuma puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  EXPECT_EQ(puma.ask("emulate sensor=crc"), "ok");
  puma.run(2);
  EXPECT_NE(puma.ask("status").find(" sensor=SENSOR_BAD_CRC"), std::string::npos);
  EXPECT_EQ(puma.ask("emulate sensor=none air_c=31.5"), "ok");
  puma.run(2);
  EXPECT_NE(puma.ask("status").find(" sensor=well"), std::string::npos);
  EXPECT_EQ(puma.cabinet->sensor().field().air_celsius, 31.5);
}

TEST(Emulation, of_the_bus_is_told_once_and_not_of_every_drive) {
  EmulatedPuma puma;
  ASSERT_TRUE(puma.enable());
  EXPECT_EQ(puma.ask("emulate can=down"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 0.1));
  puma.run(0.1);
  std::size_t lines = 0;
  for (const std::string& line : puma.console.told) {
    if (line.find("BUS_DOWN") != std::string::npos) ++lines;
  }
  EXPECT_EQ(lines, 1U);
  EXPECT_EQ(puma.ask("emulate can=up"), "ok");
  EXPECT_EQ(puma.ask("reset"), "ok");
  EXPECT_TRUE(puma.enable());
}

TEST(Emulation, refuses_what_it_does_not_know_before_it_changes_anything) {
  EmulatedPuma puma;
  ASSERT_TRUE(puma.enable());
  puma.expect_refused("emulate", "joint=2 fault=blocked");
  puma.expect_refused("emulate sensor=silent colour=red", "colour is no key of emulate");
  puma.expect_refused("emulate can2=down", "can2 is not configured");
  puma.expect_refused("emulate joint=2 fault=tired", "tired is no fault of a drive");
  puma.expect_refused("emulate joint=7 fault=blocked", "OUT_OF_RANGE");
  puma.expect_refused("emulate joint=1.5 fault=blocked", "OUT_OF_RANGE");
  puma.expect_refused("emulate joint=two fault=blocked", "joint needs a number");
  puma.expect_refused("emulate fault=blocked", "fault needs joint=2");
  puma.expect_refused("emulate sensor=tired", "tired is no fault of the sensor");
  puma.expect_refused("emulate dropout=2", "OUT_OF_RANGE");
  puma.expect_refused("emulate can=sideways", "neither up, down nor off");
  puma.expect_refused("emulate can=", "neither up, down nor off");
  puma.expect_refused("emulate push_deg=3", "push_deg needs joint=2");
  puma.expect_refused("emulate code=9040", "code needs joint=2");
  puma.expect_refused("emulate joint=2 code=9040", "code needs fault=emergency");
  puma.expect_refused("emulate joint=2", "joint needs fault= or push_deg=");
  puma.expect_refused("emulate joint=2 push_mm=3", "push_mm is of the other type of joint");
  puma.expect_refused("emulate joint=2 fault=blocked air_c=31 can=sideways", "neither up");
  EXPECT_EQ(puma.cabinet->sensor().field().air_celsius, 20);
  EXPECT_EQ(puma.ask("move q2_deg=-80"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kServoing, 0.5) && puma.run_until(Mode::kHolding, 20));
  puma.run(2);
  EXPECT_EQ(puma.mode(), Mode::kHolding);
  EXPECT_NE(puma.ask("status").find(" sensor=well"), std::string::npos);
}

TEST(Emulation, stands_in_the_list_of_requests) {
  EmulatedPuma puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  EXPECT_TRUE(puma.ask("help").ends_with(",help,emulate"));
  EXPECT_TRUE(
      puma.ask("help emulate")
          .starts_with("ok verb=emulate "
                       "modes=starting,idle,holding,servoing,sweeping,homing,faulted alone=no "));
  EXPECT_TRUE(puma.ask("help move").starts_with("ok verb=move "));
}

// The controller of a real arm, and one whose threads run in real time.
TEST(Emulation, without_a_cabinet_is_refused) {
  test::LineConsole console;
  cabinet::EmulationConsole emulation(console);
  console.requests.emplace_back("emulate joint=1 fault=blocked");
  EXPECT_FALSE(emulation.read_line());
  ASSERT_EQ(console.replies.size(), 1U);
  EXPECT_TRUE(console.replies[0].starts_with("error UNSUPPORTED "));
}

// Where the ball is, from the socket.
double off_m(EmulatedPuma& puma) {
  const simulated::SimulatedArm& arm = puma.cabinet->arm();
  const Pose X_SF = simulated::link_pose(arm, puma.cabinet->sensor().true_readings(), 6);
  return (X_SF * Vector3(0.15, 0, 0.05) - arm.X_S0 * Vector3(0.4, 0.2, 0.1)).norm();
}

// The reply, which comes when the ball sits.
std::string led(EmulatedPuma& puma, const std::string& request) {
  const std::size_t before = puma.console.replies.size();
  puma.console.requests.push_back(request);
  for (int i = 0; i < 10'000 && puma.console.replies.size() == before; ++i) puma.run(0.002);
  return puma.console.replies.size() == before ? "" : puma.console.replies.back();
}

TEST(Emulation, leads_the_ball_into_a_socket_each_time_from_another_side) {
  EmulatedPuma puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  JointVector before = puma.now().positions;
  for (int touch = 0; touch < 5; ++touch) {
    ASSERT_EQ(led(puma, "emulate place=A1"), "ok");
    EXPECT_LT(off_m(puma), 0.25e-3);
    EXPECT_EQ(puma.mode(), Mode::kIdle);
    EXPECT_EQ(puma.cabinet->state().unreferenced(), 0U);
    puma.run(0.1);
    double farthest = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      farthest = std::max(farthest, std::abs(puma.now().positions[i] - before[i]));
    }
    EXPECT_GT(farthest, 0.1);
    before = puma.now().positions;
  }
  ASSERT_EQ(led(puma, "emulate place=A1 slip_mm=5"), "ok");
  EXPECT_NEAR(off_m(puma), 5e-3, 0.25e-3);
}

TEST(Emulation, leads_no_arm_that_has_torque_is_led_already_or_cannot_get_there) {
  EmulatedPuma puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.expect_refused("emulate place=B1", "B1 is no socket of the emulated world");
  puma.expect_refused("emulate place=A1 air_c=30", "place goes with slip_mm alone");
  puma.expect_refused("emulate place=A1 slip_mm=101", "OUT_OF_RANGE");
  puma.expect_refused("emulate slip_mm=1", "slip_mm needs place=A1");
  puma.expect_refused("emulate place=F", "OUT_OF_REACH");
  puma.console.requests.emplace_back("emulate place=A1");
  puma.run(0.1);
  puma.expect_refused("emulate place=A1", "WRONG_MODE");
  EXPECT_EQ(puma.ask("enable"), "ok");
  puma.run(0.1);
  EXPECT_TRUE(puma.console.replies.back().starts_with("error WRONG_MODE "));
  ASSERT_TRUE(puma.run_until(Mode::kHolding));
  puma.expect_refused("emulate place=A1", "mode=holding");
}

}  // namespace
}  // namespace armsig::controller
