// SPDX-License-Identifier: MIT
// What the controller refuses or ends by a name that no other test of it asks for.
#include <array>
#include <chrono>
#include <string>

#include <gtest/gtest.h>

#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

using std::chrono::milliseconds;
using test::PumaCabinet;

TEST(Refusals, a_move_that_names_nothing_or_nothing_known_is_an_unknown_request) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  for (const char* request : {"move", "move pace=0.5", "move w_mm=1", "move q1_mm=1",
                              "move q9_deg=1", "move q1_deg=1 x_mm=1", "dance"}) {
    EXPECT_TRUE(puma.ask(request).starts_with("error UNKNOWN_REQUEST ")) << request;
  }
  EXPECT_EQ(puma.mode(), Mode::kHolding);
}

TEST(Refusals, of_joints_units_and_rows_that_there_are_not) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  for (const char* request :
       {"move q0_deg=1", "move q7_deg=1", "move q1_cm=1", "move q12_deg=1", "log row=1 row=2",
        "log row=1 x=2", "log rows=1", "identify anew=no"}) {
    EXPECT_TRUE(puma.ask(request).starts_with("error UNKNOWN_REQUEST ")) << request;
  }
  for (const char* request : {"log row=0", "log row=1", "identify accuracy_mm=1 anew=maybe"}) {
    EXPECT_TRUE(puma.ask(request).starts_with("error OUT_OF_RANGE ")) << request;
  }
  for (const char* request : {"pause", "resume"}) {
    EXPECT_TRUE(puma.ask(request).starts_with("error WRONG_MODE ")) << request;
  }
  EXPECT_EQ(puma.mode(), Mode::kHolding);
}

TEST(Refusals, of_a_value_that_is_no_number_name_the_key) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  const std::string refusal = "error UNKNOWN_REQUEST the request or one of its keys is unknown";
  const std::array<std::array<const char*, 2>, 9> requests{
      {{"move q1_deg=ten", "q1_deg"},
       {"move dq1_deg=", "dq1_deg"},
       {"move q1_deg=1e", "q1_deg"},
       {"move x_mm=1,5", "x_mm"},
       {"move qw=one qx=0", "qw"},
       {"move q1_deg=1 pace=slow", "pace"},
       {"confirm q2_deg=10deg", "q2_deg"},
       {"identify accuracy_mm=fine", "accuracy_mm"},
       {"log row=one", "row"}}};
  for (const auto& [request, key] : requests) {
    EXPECT_EQ(puma.ask(request), refusal + " why=\"" + key + " needs a number\"") << request;
  }
  EXPECT_EQ(puma.mode(), Mode::kHolding);
}

TEST(Refusals, of_a_number_that_is_not_finite_are_of_its_range) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  for (const char* number : {"nan", "inf", "-inf", "+infinity", "1e999", "-9e999"}) {
    for (const char* request : {"move q1_deg=", "move z_mm=", "log row="}) {
      EXPECT_TRUE(puma.ask(request + std::string(number)).starts_with("error OUT_OF_RANGE "))
          << request << number;
    }
  }
  EXPECT_EQ(puma.mode(), Mode::kHolding);
}

TEST(Refusals, a_grid_that_was_never_taught_can_t_be_touched) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  EXPECT_TRUE(puma.ask("touch-grid").starts_with("error UNSUPPORTED "));
  EXPECT_EQ(puma.mode(), Mode::kHolding);
}

TEST(Refusals, a_line_that_would_need_a_joint_faster_than_its_limit_is_not_followed) {
  const Configuration configuration = test::puma_controller();
  const Model model = model_of(configuration.drawing);
  const JointVector from{radians(0),  radians(-90), radians(10),
                         radians(30), radians(40),  radians(0)};
  Pose to = *tool_pose(model, from);
  to.p += Vector3(0.05, 0, -0.1);
  const Planned planned = plan_line(configuration, model, from, to);
  ASSERT_TRUE(planned);
  const double first = minimum_jerk(hal::seconds(configuration.period) / planned->duration_s);
  calibration::LatelyTurned lately;
  EXPECT_TRUE(readings_at(*planned, configuration, model, from, first, lately));
  // As if all ticks of the first half had been lost.
  const auto jump = readings_at(*planned, configuration, model, from, 0.5, lately);
  EXPECT_EQ(test::failure_of(jump), Error::kSpeedLimit);
}

// The bound is that of the configuration, exactly, and holds only where there is torque.
TEST(Refusals, a_tick_that_comes_too_late_stops_an_enabled_arm) {
  const hal::Duration latest = test::puma_controller().supervision.latest_tick;
  PumaCabinet puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.cabinet->controller().tick(latest + milliseconds(1));
  puma.run(0.01);
  EXPECT_EQ(puma.mode(), Mode::kIdle) << "without torque";
  ASSERT_TRUE(puma.enable());
  puma.cabinet->controller().tick(latest);
  puma.run(0.01);
  EXPECT_EQ(puma.mode(), Mode::kHolding) << "as late as it may be";
  puma.cabinet->controller().tick(latest + hal::Duration(1));
  puma.run(0.01);
  ASSERT_EQ(puma.mode(), Mode::kFaulted);
  EXPECT_EQ(puma.now().fault->error, Error::kLateTick);
}

TEST(Refusals, air_that_jumps_pauses_the_identification_and_air_that_warms_does_not) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  puma.run(10);
  const IdentificationSequence& sequence = puma.cabinet->state().identification();
  double& air_celsius = puma.cabinet->sensor().field().air_celsius;
  air_celsius += 1.5;  // 2 K between two readings are too many
  puma.run(5);
  EXPECT_FALSE(sequence.is_paused());
  // Every reading jumps, as that of a broken thermometer does.
  for (int i = 0; i < 300 && !sequence.is_paused(); ++i) {
    air_celsius += i % 2 == 0 ? 3 : -3;
    puma.run(0.02);
  }
  ASSERT_TRUE(sequence.is_paused());
  EXPECT_EQ(sequence.pause_reason(), Error::kAirChanged);
}

// With a sensor four times as bad as that of the active signature, the second one has not beaten it
// on poses held out.
TEST(Refusals, a_candidate_that_is_no_better_than_the_active_signature_is_not_accepted) {
  PumaCabinet puma;
  const auto identify = [&puma] {
    EXPECT_EQ(puma.ask("identify"), "ok");
    puma.run_until(Mode::kSweeping, 1);
    EXPECT_TRUE(puma.run_until(Mode::kHolding, 3600));
    return puma.ask("accept");
  };
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(identify(), "ok");
  const auto active = encode(*puma.cabinet->state().active());
  puma.cabinet->sensor().field().range_sigma_m *= 4;
  const std::string reply = identify();
  EXPECT_TRUE(reply.starts_with("error CANDIDATE_NO_BETTER ")) << reply;
  EXPECT_EQ(encode(*puma.cabinet->state().active()), active);
}

TEST(Refusals, a_memory_without_room_for_a_signature_keeps_none) {
  PumaCabinet puma;
  test::RamMemory small({.page_bytes = 256, .pages_per_sector = 8, .sectors = 8});
  puma.device = &small;
  puma.start(test::puma_controller(), 1);
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kSweeping, 1));
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 3600));
  EXPECT_TRUE(puma.ask("fetch what=candidate").starts_with("ok bytes="));
  EXPECT_TRUE(puma.ask("accept").starts_with("error ADDRESS_OUT_OF_RANGE "));
  EXPECT_FALSE(puma.cabinet->state().active());
}

}  // namespace
}  // namespace armsig::controller
