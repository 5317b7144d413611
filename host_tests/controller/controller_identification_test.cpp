// SPDX-License-Identifier: MIT
// The whole story in virtual time: power up, identify, accept, touch the grid, restart.
#include <chrono>

#include <gtest/gtest.h>

#include "core/evaluation/comparison.hpp"
#include "core/identification.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

constexpr double kLongest_s = 3600;

Configuration with_grid() {
  Configuration configuration = test::puma_controller();
  const evaluation::ToolModel drawing{
      .chain = kinematics::make_chain(configuration.drawing.joints, configuration.drawing.limits),
      .p_nT = test::puma_world().arm.targets[0].p_L};
  const auto placed = evaluation::place_grid(drawing, configuration.grid.grid);
  EXPECT_TRUE(placed);
  configuration.grid.grid = placed->grid;
  configuration.grid.taught = placed->taught;
  configuration.dwell.pings = 8;
  return configuration;
}

bool identify_and_accept(PumaCabinet& puma) {
  if (!puma.enable() || puma.ask("identify") != "ok") return false;
  puma.run_until(Mode::kSweeping, 1);
  if (!puma.run_until(Mode::kHolding, kLongest_s)) return false;
  return puma.ask("accept") == "ok";
}

Signature truth() {
  const cabinet::World world = test::puma_world();
  const KnownTarget target{1, 6, world.arm.targets[0].p_L};
  return signature_of(world.arm.arm, test::puma_configuration(), world.arm.X_S0, {&target, 1});
}

// The measuring machine at each vertex that the controller says it touches.
evaluation::GridReadings touch(PumaCabinet& puma, const Configuration& configuration) {
  const cabinet::World world = test::puma_world();
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

TEST(Identification, reaches_the_indices_of_table_3_on_robot_1_and_survives_a_restart) {
  const auto began = std::chrono::steady_clock::now();
  const Configuration configuration = with_grid();
  ASSERT_TRUE(check(configuration));
  PumaCabinet puma(4, configuration);
  ASSERT_TRUE(identify_and_accept(puma))
      << (puma.console.told.empty() ? "" : puma.console.told.back());
  const auto readings = touch(puma, configuration);
  ASSERT_EQ(readings.p_W.size(), configuration.grid.grid.vertex_count());
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  const double speed = hal::seconds(puma.now().now.time_since_epoch()) / wall_s;
  RecordProperty("times_real_time", std::to_string(speed));

  auto measured = readings;
  evaluation::quantise(measured, {});
  const Signature committed = puma.cabinet->state().active()->signature;
  auto comparison = evaluation::compare(configuration.drawing, committed, truth());
  ASSERT_TRUE(comparison);
  comparison->with_signature = evaluation::indices(configuration.grid.grid, measured);
  const auto factors = evaluation::improvement(*comparison);
  const auto printed = tool::table3(1);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_GE(factors[k], printed[k]) << "index " << k + 1;
    RecordProperty("index_" + std::to_string(k + 1), std::to_string(factors[k]));
    std::printf("index %zu: %.1f (paper %.1f)\n", k + 1, factors[k], printed[k]);
  }
  std::printf("%.0f s of virtual time at %.0f times real time\n",
              hal::seconds(puma.now().now.time_since_epoch()), speed);

  const auto image = encode(*puma.cabinet->state().active());
  puma.start(configuration, 2);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  ASSERT_TRUE(puma.cabinet->state().active());
  EXPECT_EQ(encode(*puma.cabinet->state().active()), image);
}

TEST(Identification, gives_the_same_signature_bit_by_bit_for_the_same_seed) {
  std::array<std::vector<std::uint8_t>, 2> memories;
  for (auto& memory : memories) {
    PumaCabinet puma(7);
    ASSERT_TRUE(identify_and_accept(puma));
    memory = puma.memory.bytes;
  }
  EXPECT_EQ(memories[0], memories[1]);
}

TEST(Identification, accepts_and_rolls_back_without_a_jump_of_the_joints) {
  PumaCabinet puma;
  ASSERT_TRUE(identify_and_accept(puma));
  const JointVector before = puma.now().commanded;
  ASSERT_EQ(puma.ask("rollback"), "ok");
  puma.run(0.1);
  EXPECT_FALSE(puma.cabinet->state().active());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(puma.now().commanded[i], before[i]);
  EXPECT_TRUE(puma.ask("rollback").starts_with("error"));
}

TEST(Identification, pauses_for_trouble_of_the_sensor_and_goes_on) {
  for (const Error error : {Error::kSensorSilent, Error::kSensorStale, Error::kSensorBadCrc,
                            Error::kSensorWrongUnit, Error::kSensorException, Error::kBusDown}) {
    PumaCabinet puma;
    ASSERT_TRUE(puma.enable());
    ASSERT_EQ(puma.ask("identify"), "ok");
    puma.run(10);
    const IdentificationSequence& sequence = puma.cabinet->state().identification();
    puma.cabinet->sensor().set_error(error);
    puma.run(5);
    ASSERT_TRUE(sequence.is_paused()) << describe(error);
    EXPECT_EQ(sequence.pause_reason(), error);
    EXPECT_EQ(puma.memory.changed, 0U);
    const std::size_t points = sequence.points_done();
    puma.cabinet->sensor().set_error({});
    ASSERT_EQ(puma.ask("resume"), "ok");
    puma.run(10);
    EXPECT_FALSE(sequence.is_paused());
    EXPECT_GT(sequence.points_done(), points);
  }
}

TEST(Identification, pauses_where_the_air_temperature_is_implausible) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  puma.run(10);
  puma.cabinet->sensor().field().air_celsius = 85;
  puma.run(5);
  EXPECT_TRUE(puma.cabinet->state().identification().is_paused());
  EXPECT_EQ(puma.cabinet->state().identification().pause_reason(), Error::kTemperatureImplausible);
}

TEST(Identification, lives_with_30_percent_of_drop_outs) {
  PumaCabinet puma;
  puma.cabinet->sensor().field().dropout_probability = 0.3;
  EXPECT_TRUE(identify_and_accept(puma));
}

TEST(Identification, has_nothing_to_accept_before_it_is_done) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  EXPECT_TRUE(puma.ask("accept").starts_with("error"));
  EXPECT_TRUE(puma.ask("candidate").starts_with("error"));
  EXPECT_TRUE(puma.ask("rollback").starts_with("error"));
  EXPECT_EQ(puma.memory.changed, 0U);
}

}  // namespace
}  // namespace armsig::controller
