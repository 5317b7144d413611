// SPDX-License-Identifier: MIT
// The whole story on the Puma's virtual cabinet, up to the four indices of Table 3: identify,
// accept, touch the grid while a measuring machine reads where the tool truly is.
#pragma once

#include <array>

#include <gtest/gtest.h>

#include "core/identification.hpp"
#include "firmware/analysis/evaluation/comparison.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::test {

inline constexpr double kLongestIdentification_s = 3600;

// With the grid of the paper where the drawing has room for it. The forearm lies level in the
// signature configuration, so that the target is far from axis 1 (docs/bench.md), and each sweep
// goes on until its axis is known to 6e-5 rad.
inline controller::Configuration puma_with_grid() {
  controller::Configuration configuration = puma_controller();
  const evaluation::ToolModel drawing{
      .chain = kinematics::make_chain(configuration.drawing.joints, configuration.drawing.limits),
      .p_nT = puma_world().arm.targets[0].p_L};
  const auto placed = evaluation::place_grid(drawing, configuration.grid.grid);
  EXPECT_TRUE(placed);
  configuration.grid.grid = placed->grid;
  configuration.grid.taught = placed->taught;
  configuration.dwell.pings = 8;
  configuration.sweeps.configuration[2] = 0;
  configuration.sweeps.arc_rad = radians(320);
  configuration.sweeps.axis_sigma_rad = 6e-5;
  return configuration;
}

// The same in a minute: few points, a grid of eight vertices.
inline controller::Configuration quick_puma_with_grid() {
  controller::Configuration configuration = puma_with_grid();
  configuration.grid.grid.count = {2, 2, 2};
  configuration.dwell.pings = 3;
  configuration.sweeps.points = configuration.sweeps.most_points = 8;
  configuration.sweeps.validation_poses = 3;
  return configuration;
}

// A range node on CAN has six receivers, in three PDOs: the first six of the eight.
inline controller::Configuration with_six_receivers(controller::Configuration configuration) {
  auto& p_S = configuration.sensor.receivers.p_S;
  const auto eight = p_S;
  p_S.clear();
  for (std::size_t i = 0; i < 6; ++i) p_S.push_back(eight[i]);
  return configuration;
}

inline bool identify_and_accept(PumaCabinet& puma) {
  if (!puma.enable() || puma.ask("identify") != "ok") return false;
  puma.run_until(controller::Mode::kSweeping, 1);
  if (!puma.run_until(controller::Mode::kHolding, kLongestIdentification_s)) return false;
  return puma.ask("accept") == "ok";
}

// The measuring machine at each vertex that the controller says it touches.
inline evaluation::GridReadings touch_grid(PumaCabinet& puma,
                                           const controller::Configuration& configuration) {
  const cabinet::World world = puma_world();
  const auto tool = [&](const JointVector& q) {
    const Pose X_S6 = simulated::link_pose(world.arm, q, 6);
    return Pose{X_S6.R, X_S6 * world.arm.targets[0].p_L};
  };
  const auto& taught = configuration.grid.taught;
  const Pose X_ST = tool(taught[0]);
  const Pose X_WS =
      evaluation::taught_frame(X_ST.p, tool(taught[1]).p, tool(taught[2]).p).inverse();
  evaluation::GridReadings readings;
  EXPECT_EQ(puma.ask("touch-grid"), "ok");
  std::size_t seen = puma.cabinet->state().grid().touched();
  for (int i = 0; i < 2'000'000 && puma.cabinet->state().grid().is_running(); ++i) {
    puma.cabinet->step();
    const std::size_t touched = puma.cabinet->state().grid().touched();
    if (touched == seen) continue;
    seen = touched;
    const Pose X_now = tool(puma.cabinet->sensor().true_readings());
    readings.p_W.push_back(X_WS * X_now.p);
    readings.turn_rad.push_back(X_WS.R * rotation_vector(X_now.R * X_ST.R.transpose()));
  }
  return readings;
}

// Normal, perpendicular, radial, orientation: how many times better than the drawing. Zeros where
// the run did not come to its end, which is a failure.
inline std::array<double, 4> table_3_run(PumaCabinet& puma,
                                         const controller::Configuration& configuration) {
  const bool identified = identify_and_accept(puma);
  EXPECT_TRUE(identified) << (puma.console.told.empty() ? "" : puma.console.told.back());
  if (!identified) return {};
  auto measured = touch_grid(puma, configuration);
  const evaluation::Grid& grid = configuration.grid.grid;
  EXPECT_EQ(measured.p_W.size(), grid.vertex_count());
  if (measured.p_W.size() != grid.vertex_count()) return {};
  evaluation::quantise(measured, {});
  const cabinet::World world = puma_world();
  const KnownTarget target{1, 6, world.arm.targets[0].p_L};
  const Signature truth =
      signature_of(world.arm.arm, puma_configuration(), world.arm.X_S0, {&target, 1});
  auto comparison = evaluation::compare(configuration.drawing, truth, truth, grid);
  EXPECT_TRUE(comparison);
  if (!comparison) return {};
  comparison->with_signature = evaluation::indices(grid, measured);
  return evaluation::improvement(*comparison);
}

}  // namespace armsig::test
