// SPDX-License-Identifier: MIT
// The whole controller about drives that interpolate positions, or make profiles of their own.
#include <gtest/gtest.h>

#include "host_tests/support/puma_cabinet.hpp"
#include "host_tests/support/table_3_run.hpp"

namespace armsig::controller {
namespace {

using cia402::PositionMode;
using test::PumaCabinet;

// Ramps of the profiles, told to the drives by writes of the configuration.
struct ModeCabinet : PumaCabinet {
  ModeCabinet(PositionMode mode, double ramp_rad_s2) {
    canopen::Configuration bus = test::puma_bus();
    const auto ramp = static_cast<std::uint32_t>(ramp_rad_s2 * test::kPumaCountsPerRadian);
    for (canopen::AxisConfiguration& axis : bus.axes) {
      axis.mode = mode;
      axis.writes = {{0x6083, 0, 4, ramp}, {0x6084, 0, 4, ramp}};
    }
    cabinet::World world = test::puma_world();
    world.drive = test::honest_puma_drive();
    cabinet.reset();
    cabinet = std::make_unique<cabinet::VirtualCabinet>(test::puma_controller(), bus, world, memory,
                                                        consoles);
  }
};

TEST(ControllerPositionModes, identify_and_accept_as_by_cyclic_positions) {
  for (const auto mode : {PositionMode::kInterpolated, PositionMode::kProfile}) {
    ModeCabinet puma(mode, 50);
    ASSERT_TRUE(test::identify_and_accept(puma)) << puma.console.replies.back();
    EXPECT_TRUE(puma.cabinet->state().active());
  }
}

TEST(ControllerPositionModes, arrive_where_they_are_moved_to_and_stop_on_the_way) {
  for (const auto mode : {PositionMode::kInterpolated, PositionMode::kProfile}) {
    ModeCabinet puma(mode, 50);
    ASSERT_TRUE(puma.enable());
    ASSERT_EQ(puma.ask("move q1_deg=30"), "ok");
    ASSERT_TRUE(puma.run_until(Mode::kServoing, 0.5) && puma.run_until(Mode::kHolding, 20));
    puma.run(0.5);
    EXPECT_NEAR(degrees(puma.now().positions[0]), 30, 0.01);
    ASSERT_EQ(puma.ask("move q1_deg=-30"), "ok");
    puma.run(0.7);
    ASSERT_EQ(puma.ask("stop"), "ok");
    ASSERT_TRUE(puma.run_until(Mode::kFaulted, 1));
    puma.run(1);
    const double stands = puma.now().positions[0];
    puma.run(1);
    EXPECT_NEAR(puma.now().positions[0], stands, 1e-5);
  }
}

// 1 rad/s on ramps of 2 rad/s^2: the drive is v^2 / 2a = 0.25 rad behind, the bound is 0.05.
TEST(ControllerPositionModes, whose_ramps_are_too_slow_are_stopped_by_their_following_error) {
  ModeCabinet puma(PositionMode::kProfile, 2);
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("move q1_deg=60"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 5));
  EXPECT_NE(puma.ask("status").find("FOLLOWING_ERROR"), std::string::npos);
}

}  // namespace
}  // namespace armsig::controller
