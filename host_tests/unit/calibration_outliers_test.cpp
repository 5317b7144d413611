// SPDX-License-Identifier: MIT
// Which rows the estimator takes for blunders, and what it counts of them.
#include <gtest/gtest.h>

#include "host_tests/support/engine_case.hpp"

namespace armsig::calibration {
namespace {

using test::Cell;
using test::EngineCase;
using test::kGeometryAlone;
using test::kRowSigma_m;
using test::position_rows;
using test::Random;

Cell cell_of_targets(const std::vector<Vector3>& p_tool, Random& random) {
  Cell cell = test::puma_cell(random, {0, 0, 0});
  cell.p_tool = p_tool;
  return cell;
}

TEST(Outliers, are_counted_with_what_is_kept_of_each_target) {
  Random random(41);
  const Cell cell = cell_of_targets({Vector3(0.1, 0, 0.1), Vector3(-0.1, 0.1, 0.1)}, random);
  std::vector<FitRow> rows = position_rows(cell, 60, kRowSigma_m, random);
  for (std::size_t k = 0; k < 5; ++k) rows[2 * k + k % 2].p_S.x() += 0.02;
  EngineCase fit(cell.arm, cell.X_SB, cell.p_tool, rows);
  const auto summary = fit.engine().run(kGeometryAlone);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->rows, 120U);
  EXPECT_EQ(summary->rejected, 5U);
  EXPECT_EQ(fit.targets[0].kept, 57U);
  EXPECT_EQ(fit.targets[1].kept, 58U);
}

TEST(Outliers, that_were_held_out_are_not_counted) {
  Random random(42);
  const Cell cell = cell_of_targets({Vector3(0.1, 0, 0.1)}, random);
  std::vector<FitRow> rows = position_rows(cell, 60, kRowSigma_m, random);
  for (std::size_t k = 0; k < 6; ++k) {
    rows[k].p_S.x() += 0.02;
    rows[k].held_out = k < 2;
  }
  EngineCase fit(cell.arm, cell.X_SB, cell.p_tool, rows);
  const auto summary = fit.engine().run(kGeometryAlone);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->rows, 58U);
  EXPECT_EQ(summary->rejected, 4U);
}

// Where all targets of a pose are off alike, it is the arm that gave way: only the one among them
// that is off otherwise is a blunder.
TEST(Outliers, of_a_pose_that_is_off_as_a_whole_are_those_that_do_not_go_with_it) {
  Random random(43);
  const Cell cell =
      cell_of_targets({Vector3(0.1, 0, 0.1), Vector3(-0.1, 0.1, 0.1), Vector3(0.05, -0.1, 0.15),
                       Vector3(0, 0.08, 0.2), Vector3(-0.08, -0.06, 0.05)},
                      random);
  std::vector<FitRow> rows = position_rows(cell, 50, kRowSigma_m, random);
  for (FitRow& row : rows) {
    if (row.index == 7) row.p_S += Vector3(3e-3, -1e-3, 2e-3);
    if (row.index == 7 && row.target == 3) row.p_S += Vector3(-0.2, 0.5, 0.1);
  }
  EngineCase fit(cell.arm, cell.X_SB, cell.p_tool, rows);
  const auto summary = fit.engine().run(kGeometryAlone);
  ASSERT_TRUE(summary);
  for (const FitRow& row : fit.rows) {
    EXPECT_EQ(row.weight, row.index == 7 && row.target == 3 ? 0 : 1) << row.index;
  }
}

}  // namespace
}  // namespace armsig::calibration
