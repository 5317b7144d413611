// SPDX-License-Identifier: MIT
// The play of the joints, found beside the rest from rows that tell their sides.
#include <cmath>

#include <gtest/gtest.h>

#include "core/calibration/play_block.hpp"
#include "host_tests/support/engine_case.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::calibration {
namespace {

using test::Cell;
using test::EngineCase;
using test::kGeometryAlone;
using test::Random;

constexpr double kHalf = radians(0.02);
constexpr double kPlaySigma_m = 2e-5;
constexpr std::uint8_t kAllSix = 0x3F;

// Rows of which the sides of the joints in `sided` are known; every joint lags by kHalf.
std::vector<FitRow> lagging_rows(const Cell& cell, int poses, std::uint8_t sided, Random& random) {
  std::vector<FitRow> rows;
  for (int k = 0; k < poses; ++k) {
    const JointVector readings = random.configuration(cell.arm);
    JointVector q = readings;
    std::uint8_t sides = 0;
    for (std::size_t j = 0; j < q.size(); ++j) {
      const bool grew = random.uniform(-1, 1) > 0;
      if (grew) sides |= static_cast<std::uint8_t>(1U << j);
      if ((sided >> j & 1U) != 0) q[j] -= grew ? kHalf : -kHalf;
    }
    rows.push_back(
        test::position_row(readings, cell.point(q, 0) + random.normal_vector(kPlaySigma_m)));
    rows.back().sides = sides;
    rows.back().sided = sided;
  }
  return rows;
}

// Half of a joint's play as the rows alone say, the prior taken out again.
double half_play(const PlayBlock& play, int joint, int joints) {
  const Eigen::MatrixXd told = play.told.topLeftCorner(joints, joints);
  const Eigen::VectorXd pulled = play.gradient.head(joints);
  return play.half[joint] + told.ldlt().solve(pulled)[joint];
}

TEST(Play, is_found_where_rows_tell_from_which_side_they_were_reached) {
  Random random(71);
  const Cell cell = test::puma_cell(random);
  std::vector<FitRow> rows = lagging_rows(cell, 200, kAllSix, random);
  // Nobody knows the sides of some: they tell of the rest alone.
  for (std::size_t k = 0; k < 20; ++k) {
    rows[k].sided = 0;
    rows[k].p_S = cell.point(rows[k].readings, 0);
  }
  EngineCase with(test::puma(), cell.X_SB, {cell.p_tool[0]}, rows);
  EngineCase without(test::puma(), cell.X_SB, {cell.p_tool[0]}, rows);
  PlayBlock play;
  with.engine().find_play(play);
  ASSERT_TRUE(with.engine().run(kGeometryAlone));
  ASSERT_TRUE(without.engine().run(kGeometryAlone));
  for (int j = 0; j < 6; ++j) EXPECT_NEAR(half_play(play, j, 6), kHalf, 0.1 * kHalf) << j;
  EXPECT_NEAR(std::sqrt(with.engine().scales().sigma_squared), kPlaySigma_m, 0.2 * kPlaySigma_m);
  EXPECT_GT(std::sqrt(without.engine().scales().sigma_squared), 4 * kPlaySigma_m);
}

TEST(Play, is_found_beside_maps_of_the_readings) {
  Random random(72);
  const Cell cell = test::puma_cell(random);
  EngineCase fit(test::puma(), cell.X_SB, {cell.p_tool[0]},
                 lagging_rows(cell, 300, kAllSix, random));
  PlayBlock play;
  fit.engine().find_play(play);
  ASSERT_TRUE(fit.engine().run({.gravity = false, .maps = true}));
  for (int j = 0; j < 6; ++j) EXPECT_NEAR(half_play(play, j, 6), kHalf, 0.15 * kHalf) << j;
}

TEST(Play, of_joints_whose_side_is_not_told_stays_open) {
  Random random(73);
  const Cell cell = test::puma_cell(random);
  EngineCase fit(test::puma(), cell.X_SB, {cell.p_tool[0]}, lagging_rows(cell, 120, 0x07, random));
  PlayBlock play;
  fit.engine().find_play(play);
  ASSERT_TRUE(fit.engine().run(kGeometryAlone));
  for (int j = 0; j < 3; ++j) EXPECT_NEAR(half_play(play, j, 3), kHalf, 0.1 * kHalf) << j;
  for (int j = 3; j < 6; ++j) {
    EXPECT_EQ(play.half[j], 0) << j;
    EXPECT_EQ(play.told(j, j), 0) << j;
  }
}

// As if every joint lagged by a quarter more there: too little for the gate.
TEST(Play, is_not_taken_from_rows_held_out_and_blunders) {
  Random random(74);
  const Cell cell = test::puma_cell(random);
  std::vector<FitRow> rows = lagging_rows(cell, 240, kAllSix, random);
  for (std::size_t k = 0; k < 120; ++k) {
    JointVector q = rows[k].readings;
    for (std::size_t j = 0; j < 6; ++j) q[j] -= side_at(rows[k], j) * 1.25 * kHalf;
    rows[k].p_S = cell.point(q, 0);
    rows[k].held_out = true;
  }
  for (std::size_t k = 120; k < 125; ++k) rows[k].p_S += Vector3(0, 0, 0.02);
  EngineCase fit(test::puma(), cell.X_SB, {cell.p_tool[0]}, rows);
  PlayBlock play;
  fit.engine().find_play(play);
  const auto summary = fit.engine().run(kGeometryAlone);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->rejected, 5U);
  for (int j = 0; j < 6; ++j) EXPECT_NEAR(half_play(play, j, 6), kHalf, 0.1 * kHalf) << j;
}

// The predicted place of a pose reached from a known side is as uncertain as the play is.
TEST(Play, adds_to_what_is_stated_of_a_row_that_tells_its_sides) {
  Random random(75);
  const Cell cell = test::puma_cell(random);
  EngineCase fit(test::puma(), cell.X_SB, {cell.p_tool[0]},
                 lagging_rows(cell, 100, kAllSix, random));
  PlayBlock play;
  fit.engine().find_play(play);
  ASSERT_TRUE(fit.engine().run(kGeometryAlone));
  FitRow row = fit.rows[0];
  const ChainFrames frames = fit.frames(row.readings);
  const double sided = fit.engine().covariance_of(row, frames).model.trace();
  row.sided = 0;
  const double unsided = fit.engine().covariance_of(row, frames).model.trace();
  EXPECT_GT(sided, 1.2 * unsided);
}

// A joint behind the target's link moves nothing of it.
TEST(Play, of_joints_behind_the_targets_link_is_not_told) {
  Random random(76);
  const Cell cell = test::puma_cell(random);
  std::vector<FitRow> rows;
  for (int k = 0; k < 120; ++k) {
    const JointVector q = random.configuration(cell.arm);
    rows.push_back(test::position_row(q, cell.frame(q, 4) * cell.p_tool[0]));
    rows.back().p_S += random.normal_vector(kPlaySigma_m);
    rows.back().sided = kAllSix;
    rows.back().sides = static_cast<std::uint8_t>(random.uniform(0, 64));
  }
  EngineCase fit(test::puma(), cell.X_SB, {cell.p_tool[0]}, rows);
  fit.targets[0].link = 4;
  PlayBlock play;
  fit.engine().find_play(play);
  ASSERT_TRUE(fit.engine().run(kGeometryAlone));
  EXPECT_GT(play.told(3, 3), 0);
  for (int j = 4; j < 6; ++j) EXPECT_EQ(play.told(j, j), 0) << j;
}

}  // namespace
}  // namespace armsig::calibration
