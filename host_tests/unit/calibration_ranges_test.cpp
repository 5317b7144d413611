// SPDX-License-Identifier: MIT
// The estimator fed with ranges to receivers, and with what a sensor may be wrong by.
#include <gtest/gtest.h>

#include "host_tests/support/engine_case.hpp"

namespace armsig::calibration {
namespace {

using test::Cell;
using test::EngineCase;
using test::kGeometryAlone;
using test::Random;
using test::range_row;

Receivers four_receivers() {
  return {Vector3(2.5, 0.1, 0.3), Vector3(-2.4, 0.4, 0.2), Vector3(0.2, 2.6, -0.3),
          Vector3(0.1, -0.4, 2.7)};
}

// Ranges of an arm true to its drawing, by a sensor that is wrong as `sensor` says.
std::vector<FitRow> ranges(const Cell& cell, const SensorModel& sensor, int poses, double sigma_m,
                           Random& random) {
  std::vector<FitRow> rows;
  for (int k = 0; k < poses; ++k) {
    const JointVector q = random.configuration(cell.arm);
    for (std::uint8_t r = 0; r < sensor.receivers.size(); ++r) {
      const double distance = (cell.point(q, 0) - sensor.receivers[r]).norm();
      rows.push_back(range_row(
          q, r, (1 + sensor.scale) * distance + sensor.offset_m[r] + random.normal(sigma_m)));
    }
  }
  return rows;
}

Pose nearly(const Pose& X) {
  return {X.R * rotation_about(Vector3(1, 2, 2) / 3, 0.01), X.p + Vector3(5e-3, -3e-3, 4e-3)};
}

TEST(RangeFit, finds_the_offset_of_each_receiver_and_the_scale) {
  Random random(21);
  const Cell cell = test::puma_cell(random, {0, 0, 0});
  SensorModel sensor;
  sensor.receivers = four_receivers();
  sensor.offset_m = {3e-3, -2e-3, 5e-3, 1e-3};
  sensor.scale = 2e-3;
  EngineCase fit(cell.arm, nearly(cell.X_SB), {cell.p_tool[0] + Vector3(4e-3, 2e-3, -3e-3)},
                 ranges(cell, sensor, 80, 0, random));
  fit.model->sensor.receivers = sensor.receivers;
  ask_for({.readings = {}, .receiver_offsets = true, .scale = true}, *fit.model);
  ASSERT_TRUE(fit.engine().run(kGeometryAlone));
  for (std::size_t r = 0; r < 4; ++r) {
    EXPECT_NEAR(fit.model->sensor.offset_m[r], sensor.offset_m[r], 2e-5) << r;
  }
  EXPECT_NEAR(fit.model->sensor.scale, sensor.scale, 1e-5);
}

TEST(RangeFit, calls_no_good_range_a_blunder) {
  Random random(25);
  const Cell cell = test::puma_cell(random, {0, 0, 0});
  SensorModel sensor;
  sensor.receivers = four_receivers();
  EngineCase fit(cell.arm, cell.X_SB, {cell.p_tool[0]}, ranges(cell, sensor, 300, 1e-4, random));
  fit.model->sensor.receivers = sensor.receivers;
  const auto summary = fit.engine().run(kGeometryAlone);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->rejected, 0U);
}

TEST(RangeFit, has_settled_after_a_few_rounds) {
  Random random(26);
  const Cell cell = test::puma_cell(random, {0, 0, 0});
  SensorModel sensor;
  sensor.receivers = four_receivers();
  EngineCase fit(cell.arm, nearly(cell.X_SB), {cell.p_tool[0]},
                 ranges(cell, sensor, 60, 1e-4, random));
  fit.model->sensor.receivers = sensor.receivers;
  const auto summary = fit.engine().run(kGeometryAlone);
  ASSERT_TRUE(summary);
  EXPECT_TRUE(summary->converged);
  EXPECT_LT(summary->rounds, 10);
}

TEST(RangeFit, predicts_ranges_that_were_held_out) {
  Random random(23);
  const Cell cell = test::puma_cell(random);
  SensorModel sensor;
  sensor.receivers = four_receivers();
  constexpr double kRangeSigma_m = 1e-4;
  EngineCase fit(test::puma(), cell.X_SB, {cell.p_tool[0]},
                 ranges(cell, sensor, 100, kRangeSigma_m, random));
  fit.model->sensor.receivers = sensor.receivers;
  ASSERT_TRUE(fit.engine().run(kGeometryAlone));
  const auto score = fit.held_out(kGeometryAlone);
  ASSERT_TRUE(score);
  EXPECT_EQ(score->rows, 400U);
  EXPECT_NEAR(score->rms_m, kRangeSigma_m, 0.3 * kRangeSigma_m);
}

// Where the target is on the receiver itself there is no way along which a range could be wrong.
TEST(RangeFit, is_not_disturbed_by_a_target_on_its_receiver) {
  Random random(24);
  const Cell cell = test::puma_cell(random, {0, 0, 0});
  SensorModel sensor;
  sensor.receivers = four_receivers();
  std::vector<FitRow> rows = ranges(cell, sensor, 60, 0, random);
  const JointVector q = random.configuration(cell.arm);
  sensor.receivers.push_back(Vector3::Zero());
  rows.push_back(range_row(q, 4, 0));
  EngineCase fit(cell.arm, cell.X_SB, {cell.p_tool[0]}, rows);
  sensor.receivers[4] = fit.predict(q);
  fit.model->sensor.receivers = sensor.receivers;
  ASSERT_TRUE(fit.engine().run(kGeometryAlone));
  const JointVector other = random.configuration(cell.arm);
  EXPECT_LT((fit.predict(other) - cell.point(other, 0)).norm(), 1e-6);
}

}  // namespace
}  // namespace armsig::calibration
