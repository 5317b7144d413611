// SPDX-License-Identifier: MIT
// Modes, moves and faults of the whole controller, over the virtual bus.
#include <gtest/gtest.h>

#include "host_tests/support/allocation_guard.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/moving_puma.hpp"

namespace armsig::controller {
namespace {

using cia402::State;
using test::MovingPuma;
using test::PumaCabinet;

bool is_error(const std::string& reply) { return reply.starts_with("error "); }

// No drive turns its motor against a fault for longer than three ticks.
void expect_safe(PumaCabinet& puma, Error error) {
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 1));
  EXPECT_EQ(puma.now().fault->error, error) << describe(puma.now().fault->error);
  puma.run(0.006);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NE(puma.cabinet->drive(i).state(), State::kOperationEnabled) << i;
  }
  EXPECT_EQ(puma.memory.stored, 0U);
}

TEST(Configuration, of_the_puma_is_accepted) { EXPECT_TRUE(check(test::puma_controller())); }

TEST(Configuration, names_the_setting_that_is_wrong) {
  Configuration reversed = test::puma_controller();
  reversed.drawing.limits[2] = {1, -1};
  ASSERT_FALSE(check(reversed));
  EXPECT_EQ(test::failure_of(check(reversed)).setting, "arm.limits");
  EXPECT_EQ(test::failure_of(check(reversed)).error, Error::kLimitsReversed);
  EXPECT_EQ(test::failure_of(check(reversed)).joint, 2U);
  Configuration few = test::puma_controller();
  few.sweeps.points = 3;
  ASSERT_FALSE(check(few));
  EXPECT_EQ(test::failure_of(check(few)).setting, "sweeps.points");
}

// A configuration with one change; what check() says of it.
template <typename F>
ConfigurationRefusal refusal_of(const F& change) {
  Configuration c = test::puma_controller();
  for (JointVector& q : c.grid.taught) q = c.sweeps.configuration;
  c.grid.taught[1][0] += 0.3;
  c.grid.taught[2][1] += 0.3;
  c.grid.grid.size_m = {0.1, 0.1, 0.1};
  c.grid.grid.count = {2, 2, 2};
  EXPECT_TRUE(check(c)) << "the unchanged one is good";
  change(c);
  const auto checked = check(c);
  if (!checked) return checked.error();
  ADD_FAILURE() << "accepted";
  return {};
}

TEST(Configuration, that_no_arm_is_like_is_refused_with_a_reason) {
  struct Slip {
    std::string_view setting;
    void (*change)(Configuration& c);
  };
  for (const Slip& slip : {
           Slip{"supervision.latest_tick",
                [](Configuration& c) { c.supervision.latest_tick = std::chrono::hours(1); }},
           Slip{"supervision.following_error",
                [](Configuration& c) { c.supervision.following_error[3] = 100; }},
           Slip{"limits.speed", [](Configuration& c) { c.limits.speed[0] = 1e6; }},
           Slip{"limits.acceleration", [](Configuration& c) { c.limits.acceleration[5] = 1e6; }},
           Slip{"limits.tool_speed", [](Configuration& c) { c.limits.tool_speed = 250; }},
           Slip{"limits.least_regularity", [](Configuration& c) { c.limits.least_regularity = 1; }},
           Slip{"dwell.tolerance", [](Configuration& c) { c.dwell.tolerance = 0.05; }},
           Slip{"dwell.tolerance",
                [](Configuration& c) { c.supervision.following_error[2] = c.dwell.tolerance; }},
           Slip{"dwell.settle", [](Configuration& c) { c.dwell.settle = std::chrono::hours(1); }},
           Slip{"sensor.reading_timeout",
                [](Configuration& c) { c.sensor.reading_timeout = std::chrono::hours(1); }},
           Slip{"sensor.air", [](Configuration& c) { c.sensor.highest_air_celsius = 300; }},
           Slip{"sensor.receivers",
                [](Configuration& c) { c.sensor.receivers.p_S[0].x() = -1000; }},
           Slip{"grid.taught", [](Configuration& c) { c.grid.taught[1] = c.grid.taught[0]; }},
           Slip{"grid.taught",
                [](Configuration& c) { c.grid.taught.fill(c.sweeps.configuration); }},
           Slip{"grid.size", [](Configuration& c) { c.grid.grid.size_m[1] = 250; }},
       }) {
    const ConfigurationRefusal refusal = refusal_of(slip.change);
    EXPECT_EQ(refusal.setting, slip.setting);
    EXPECT_FALSE(refusal.reason.empty()) << slip.setting;
  }
}

TEST(Controller, starts_without_torque) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.run(1);
  EXPECT_EQ(puma.mode(), Mode::kIdle);
  EXPECT_EQ(puma.cabinet->drive(0).state(), State::kSwitchOnDisabled);
}

TEST(Controller, moves_nothing_that_was_not_enabled) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  EXPECT_TRUE(is_error(puma.ask("move q1_deg=5")));
  EXPECT_TRUE(is_error(puma.ask("identify")));
  EXPECT_TRUE(is_error(puma.ask("touch-grid")));
  puma.run(0.5);
  EXPECT_EQ(puma.cabinet->drive(0).state(), State::kSwitchOnDisabled);
}

TEST(Controller, moves_joints_where_it_is_told) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("move q1_deg=20 q3_deg=80"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kServoing, 0.1));
  ASSERT_TRUE(puma.run_until(Mode::kHolding));
  puma.run(0.3);
  EXPECT_NEAR(puma.now().positions[0], radians(20), 3e-5);
  EXPECT_NEAR(puma.now().positions[2], radians(80), 3e-5);
}

TEST(Controller, moves_the_tool_along_a_straight_line) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.bend_wrist());
  puma.run(0.3);
  const Pose from = *puma.now().X_RT;
  ASSERT_EQ(puma.ask("move dz_mm=-100 dx_mm=50"), "ok") << puma.console.replies.back();
  const Vector3 along = Vector3(0.05, 0, -0.1).normalized();
  double worst_m = 0;
  double worst_rad = 0;
  for (int i = 0; i < 5000 && (i < 10 || puma.mode() != Mode::kHolding); ++i) {
    puma.cabinet->step();
    const Vector3 off = puma.now().X_RT->p - from.p;
    worst_m = std::max(worst_m, (off - along * along.dot(off)).norm());
    worst_rad = std::max(worst_rad, angle_between(from.R, puma.now().X_RT->R));
  }
  puma.run(0.3);
  EXPECT_LT(worst_m, 0.5e-3);  // the drives' lag and counts
  EXPECT_LT(worst_rad, 2e-3);
  EXPECT_NEAR((puma.now().X_RT->p - from.p).dot(along), Vector3(0.05, 0, -0.1).norm(), 5e-5);
}

TEST(Controller, refuses_what_is_out_of_reach_or_beyond_a_limit_before_it_moves) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  const JointVector before = puma.now().commanded;
  EXPECT_TRUE(is_error(puma.ask("move x_mm=3000 y_mm=0 z_mm=0")));
  EXPECT_TRUE(is_error(puma.ask("move q1_deg=161")));
  EXPECT_TRUE(is_error(puma.ask("move q1_deg=nan")));
  EXPECT_TRUE(is_error(puma.ask("move q1_mm=1")));
  EXPECT_TRUE(is_error(puma.ask("move q9_deg=1")));
  puma.run(0.1);
  EXPECT_EQ(puma.mode(), Mode::kHolding);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(puma.now().commanded[i], before[i]);
}

TEST(Controller, refuses_a_move_that_tells_the_same_twice) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  for (const char* twice : {"move q1_deg=1 q1_rad=1", "move q1_rad=1 q1_deg=1", "move x_mm=1 x_m=1",
                            "move z_mm=400 dz_mm=1", "move dx_m=0 dx_mm=1"}) {
    EXPECT_TRUE(puma.ask(twice).starts_with("error CONTRADICTION ")) << twice;
  }
  EXPECT_EQ(puma.mode(), Mode::kHolding);
}

TEST(Controller, refuses_a_pace_that_would_take_for_ever_or_exceeds_the_limits) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  for (const char* pace : {"1e-300", "0.0009", "0", "-1", "1.001", "nan"}) {
    for (const char* move : {"move q1_deg=1 pace=", "move dz_mm=-1 pace="}) {
      EXPECT_TRUE(puma.ask(move + std::string(pace)).starts_with("error OUT_OF_RANGE ")) << pace;
    }
  }
  EXPECT_EQ(puma.ask("move q1_deg=1 pace=0.001"), "ok");
}

TEST(Controller, refuses_a_line_through_a_singularity) {
  PumaCabinet puma;  // wrist stretched: axes 4 and 6 are one line
  ASSERT_TRUE(puma.enable());
  EXPECT_TRUE(is_error(puma.ask("move dx_mm=-150 dy_mm=150")));
  EXPECT_EQ(puma.mode(), Mode::kHolding);
}

TEST(Faults, an_emergency_of_a_drive_ends_in_a_quick_stop) {
  MovingPuma puma;
  puma.cabinet->drive(3).inject(simulated::DriveFault::kEmergency, 0x2310);
  expect_safe(puma, Error::kDriveEmergency);
  EXPECT_EQ(puma.now().fault->joint, 3U);
  EXPECT_EQ(puma.now().fault->code, 0x2310U);
  const std::string words = "code=0x2310 says=\"continuous over-current\"";
  EXPECT_NE(puma.console.told.back().find(" joint=4 " + words), std::string::npos)
      << puma.console.told.back();
  const std::string status = puma.ask("status");
  EXPECT_NE(status.find(" fault_joint=4 fault_code=0x2310 fault_says=\"continuous over-current\""),
            std::string::npos)
      << status;
}

TEST(Faults, a_lost_heartbeat_ends_in_a_quick_stop) {
  MovingPuma puma;
  puma.cabinet->drive(1).inject(simulated::DriveFault::kHeartbeatLost);
  expect_safe(puma, Error::kHeartbeatLost);
}

TEST(Faults, a_blocked_motor_ends_in_a_following_error) {
  MovingPuma puma;
  puma.cabinet->drive(0).inject(simulated::DriveFault::kBlocked);
  expect_safe(puma, Error::kFollowingError);
  EXPECT_EQ(puma.now().fault->joint, 0U);
}

TEST(Faults, the_operators_stop_ends_every_mode) {
  {
    PumaCabinet idle;
    ASSERT_TRUE(idle.run_until(Mode::kIdle));
    EXPECT_EQ(idle.ask("stop"), "ok");
    expect_safe(idle, Error::kQuickStop);
  }
  {
    PumaCabinet holding;
    ASSERT_TRUE(holding.enable());
    EXPECT_EQ(holding.ask("stop"), "ok");
    expect_safe(holding, Error::kQuickStop);
  }
  {
    MovingPuma servoing;
    EXPECT_EQ(servoing.ask("stop"), "ok");
    expect_safe(servoing, Error::kQuickStop);
  }
  {
    PumaCabinet sweeping;
    ASSERT_TRUE(sweeping.enable());
    ASSERT_EQ(sweeping.ask("identify"), "ok");
    sweeping.run(3);
    ASSERT_EQ(sweeping.mode(), Mode::kSweeping);
    EXPECT_EQ(sweeping.ask("stop"), "ok");
    expect_safe(sweeping, Error::kQuickStop);
    EXPECT_FALSE(sweeping.cabinet->state().identification().is_running());
  }
}

TEST(Faults, are_left_by_reset_only_and_end_without_torque) {
  MovingPuma puma;
  ASSERT_EQ(puma.ask("stop"), "ok");
  EXPECT_TRUE(is_error(puma.ask("enable")));
  EXPECT_TRUE(is_error(puma.ask("move q1_deg=0")));
  puma.run(1);
  EXPECT_EQ(puma.mode(), Mode::kFaulted);
  ASSERT_EQ(puma.ask("reset"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  EXPECT_TRUE(puma.enable());
}

TEST(Console, survives_garbage) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  for (const char* line : {"", "   ", "=", "a=b", "move =", "move q1_deg", "move q1_deg=1 q1_deg=2",
                           "status x=1", "log row=0", "log row=1e99", "stop now", "ENABLE"}) {
    EXPECT_TRUE(is_error(puma.ask(line))) << line;
  }
  puma.console.next_error = Error::kNotText;
  puma.run(0.01);
  EXPECT_TRUE(is_error(puma.console.replies.back()));
  EXPECT_EQ(puma.mode(), Mode::kIdle);
}

TEST(Controller, takes_nothing_from_the_heap_while_it_moves) {
  MovingPuma puma;
  const armsig::test::AllocationGuard guard;
  puma.run(0.5);
  const std::size_t allocations = guard.count();
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace armsig::controller
