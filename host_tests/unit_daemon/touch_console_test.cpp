// SPDX-License-Identifier: MIT
// Touches by request: when the readings of an arm are kept, and when they are refused.
#include "firmware/linux/touch_console.hpp"

#include <string>

#include <gtest/gtest.h>

#include "firmware/formats/touches.hpp"
#include "host_tests/cli/files.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::daemon {
namespace {

using cli::Folder;
using controller::Mode;

// A Puma 560 with a console that takes touches; its disk is the test's to wait for.
struct TouchingPuma : test::PumaCabinet {
  explicit TouchingPuma(const controller::Configuration& of = test::puma_controller())
      : configuration(of),
        recorder(configuration, {.file = (folder / "touches.csv").string(), .plan = {}}) {
    consoles[0] = &touching;
    start(configuration, 1);
    recorder.attend(cabinet->state());
  }
  // The reply to `request`, as soon as the disk is done; empty if none comes within two seconds.
  std::string touch(const std::string& request) {
    const std::size_t before = console.replies.size();
    console.requests.push_back(request);
    for (int i = 0; i < 1000 && console.replies.size() == before; ++i) {
      cabinet->step();
      recorder.write_if_due();
    }
    return console.replies.size() == before ? "" : console.replies.back();
  }
  void push(std::size_t joint, double by_rad) {
    cabinet->drive(joint).push(by_rad * test::kPumaCountsPerRadian);
  }
  [[nodiscard]] std::vector<tool::Touch> touches() const {
    tool::InstrumentDescription sockets;
    sockets.instruments.emplace_back();
    return tool::read_touches((folder / "touches.csv").string(),
                              types_of(configuration.drawing.joints), sockets)
        .value();
  }
  [[nodiscard]] bool has_file() const { return std::filesystem::exists(folder / "touches.csv"); }

  Folder folder;
  controller::Configuration configuration;
  TouchRecorder recorder;
  TouchConsole touching{console, recorder};
};

TEST(TouchConsole, keeps_the_readings_of_an_arm_led_by_hand_or_held) {
  TouchingPuma puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  EXPECT_EQ(puma.touch("touch place=A1"), "ok place=A1 at_place=1 touches=1");
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("move q1_deg=20 q6_deg=-15"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kServoing));
  ASSERT_TRUE(puma.run_until(Mode::kHolding));
  EXPECT_EQ(puma.touch("touch place=B2"), "ok place=B2 at_place=1 touches=2");
  EXPECT_EQ(puma.touch("touches"), "ok touches=2 places=A1:1,B2:1");
  const auto touches = puma.touches();
  ASSERT_EQ(touches.size(), 2U);
  EXPECT_NEAR(touches[0].q[1], radians(-90), 1e-5);
  EXPECT_NEAR(touches[1].q[0], radians(20), 1e-4);
  EXPECT_NEAR(touches[1].q[0], puma.now().positions[0], 5e-6);
  EXPECT_NEAR(touches[1].q[5], puma.now().positions[5], 5e-6);
  EXPECT_EQ(puma.touch("drop-touch"), "ok place=B2 at_place=0 touches=1");
}

TEST(TouchConsole, answers_ok_when_the_touch_is_on_the_disk_and_not_before) {
  TouchingPuma puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  EXPECT_EQ(puma.ask("touch place=A1"), "");
  EXPECT_FALSE(puma.has_file());
  puma.recorder.write_if_due();
  EXPECT_TRUE(puma.has_file());
  puma.run(0.01);
  ASSERT_EQ(puma.console.replies.size(), 1U);
  EXPECT_EQ(puma.console.replies[0], "ok place=A1 at_place=1 touches=1");
}

TEST(TouchConsole, writes_what_the_encoders_read_where_joints_are_coupled) {
  controller::Configuration coupled = test::puma_controller();
  coupled.drawing.couplings = {{4, 3, 0.014}, {5, 3, -0.013}, {5, 4, -0.18}};
  TouchingPuma puma(coupled);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  ASSERT_EQ(puma.touch("touch place=A1"), "ok place=A1 at_place=1 touches=1");
  const JointVector encoders = puma.cabinet->sensor().true_readings();
  EXPECT_GT(std::abs(puma.now().positions[4] - encoders[4]), 1e-3);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(puma.touches()[0].q[i], encoders[i], 1e-5);
}

TEST(TouchConsole, refuses_while_a_move_or_a_fault_is) {
  TouchingPuma puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("move q1_deg=20"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kServoing));
  EXPECT_EQ(puma.touch("touch place=A1"),
            "error WRONG_MODE the present mode does not allow it mode=servoing modes=idle,holding");
  ASSERT_EQ(puma.ask("stop"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kFaulted));
  EXPECT_EQ(puma.touch("touch place=A1"),
            "error WRONG_MODE the present mode does not allow it mode=faulted modes=idle,holding");
  EXPECT_EQ(puma.touch("touches"), "ok touches=0");
  EXPECT_FALSE(puma.has_file());
}

TEST(TouchConsole, refuses_a_touch_in_which_a_move_begins) {
  TouchingPuma puma;
  ASSERT_TRUE(puma.enable());
  puma.console.requests.emplace_back("touch place=A1");
  puma.run(0.05);
  EXPECT_EQ(puma.ask(puma.other, "move q1_deg=20"), "ok");
  puma.run(0.3);
  ASSERT_EQ(puma.console.replies.size(), 2U) << "of enable and touch";
  EXPECT_TRUE(puma.console.replies.back().starts_with("error WRONG_MODE "))
      << puma.console.replies.back();
  puma.recorder.write_if_due();
  EXPECT_FALSE(puma.has_file());
}

TEST(TouchConsole, refuses_a_touch_in_which_somebody_pushes_the_arm) {
  TouchingPuma puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.console.requests.emplace_back("touch place=A1");
  puma.run(0.05);
  puma.push(1, radians(0.02));
  puma.run(0.01);
  ASSERT_EQ(puma.console.replies.size(), 1U);
  EXPECT_EQ(puma.console.replies[0],
            "error ARM_MOVED the arm moved while a point was measured joint=2");
  EXPECT_EQ(puma.touch("touch place=A1"), "ok place=A1 at_place=1 touches=1");
}

TEST(TouchConsole, refuses_while_a_joint_is_unreferenced_or_its_reading_is_not_known) {
  TouchingPuma puma;
  EXPECT_TRUE(puma.touch("touch place=A1").starts_with("error WRONG_MODE ")) << "starting";
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.push(2, radians(60));
  puma.run(0.1);
  EXPECT_EQ(puma.touch("touch place=A1"),
            "error UNREFERENCED a joint may stand elsewhere than it reads unreferenced=3");
  puma.confirm();
  EXPECT_EQ(puma.touch("touch place=A1"), "ok place=A1 at_place=1 touches=1");
}

TEST(TouchConsole, takes_one_touch_at_a_time_and_gives_up_without_ticks) {
  TouchingPuma puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.console.requests.emplace_back("touch place=A1");
  puma.run(0.05);
  EXPECT_EQ(puma.ask("touch place=A1"),
            "error WRONG_MODE the present mode does not allow it why=\"a touch is under way\"");
  for (int i = 0; i < 10'001; ++i) puma.recorder.step();
  EXPECT_EQ(puma.console.replies.back(), "error LATE_TICK the servo tick came too late");
  EXPECT_EQ(puma.touch("touch place=A1"), "ok place=A1 at_place=1 touches=1");
}

TEST(TouchConsole, refuses_requests_of_another_form) {
  TouchingPuma puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  for (const char* request :
       {"touch", "touch A1", "touch q1_deg=1", "touch place=A1 sigma_mm=1", "touches all",
        "touches place=A1", "drop-touch place=A1", "touch place=A1 place=A1"}) {
    EXPECT_TRUE(puma.touch(request).starts_with("error UNKNOWN_REQUEST ")) << request;
  }
  for (const char* request : {"touch place=", "touch place=A,1", "touch place=../A1"}) {
    EXPECT_TRUE(puma.touch(request).starts_with("error OUT_OF_RANGE ")) << request;
  }
  EXPECT_FALSE(puma.has_file());
}

TEST(TouchConsole, refuses_more_than_a_slow_disk_keeps_up_with_and_answers_all_the_others) {
  TouchingPuma puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  for (int i = 0; i < 9; ++i) puma.console.requests.emplace_back("touches");
  puma.run(0.1);
  ASSERT_EQ(puma.console.replies.size(), 1U);
  EXPECT_TRUE(puma.console.replies[0].starts_with("error CAPACITY_EXCEEDED "));
  puma.recorder.write_if_due();
  puma.run(0.1);
  EXPECT_EQ(puma.console.replies.size(), 9U);
  EXPECT_EQ(puma.console.replies.back(), "ok touches=0");
}

TEST(TouchConsole, tells_its_verbs_and_passes_everything_else_on) {
  TouchingPuma puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  EXPECT_TRUE(puma.ask("help").ends_with(",help,touch,drop-touch,touches"));
  EXPECT_TRUE(puma.ask("help touch")
                  .starts_with("ok verb=touch modes=idle,holding alone=no does=\"place=A1 "));
  EXPECT_TRUE(puma.ask("help drop-touch").starts_with("ok verb=drop-touch modes=starting,idle"));
  EXPECT_TRUE(puma.ask("help move").starts_with("ok verb=move "));
  EXPECT_TRUE(puma.ask("status").starts_with("ok mode=idle "));
}

}  // namespace
}  // namespace armsig::daemon
