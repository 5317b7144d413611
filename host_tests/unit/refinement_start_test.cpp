// SPDX-License-Identifier: MIT
#include <algorithm>
#include <limits>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "core/base/links.hpp"
#include "firmware/analysis/starts/start.hpp"
#include "firmware/analysis/uncertainty/tool_covariance.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/shared_arms.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
namespace {

using test::Cell;
using test::Log;
using test::Random;

constexpr double kPoseSigma_m = 0.1e-3;

std::array<Target, 1> one_target(std::size_t link = 6) {
  std::array<Target, 1> targets;
  targets[0].number = 1;
  targets[0].link = link;
  return targets;
}

TEST(FitBaseAndTool, is_exact_for_an_arm_true_to_its_drawing) {
  Random random(1);
  const Cell cell = test::puma_cell(random, {0, 0, 0});
  Log log;
  test::add_poses(cell, 20, 0, random, log);
  const auto fitted = fit_base_and_tool(test::puma(), log, one_target());
  ASSERT_TRUE(fitted);
  EXPECT_LT(angle_between(fitted->X_SB.R, cell.X_SB.R), 1e-7);
  EXPECT_LT((fitted->X_SB.p - cell.X_SB.p).norm(), 1e-7);
  EXPECT_LT((fitted->p_LT[0] - cell.p_tool[0]).norm(), 1e-7);
  EXPECT_LT(fitted->rms_m, 1e-7);
}

// The sweep of the last joint says nothing of where the others' axes are.
TEST(FitBaseAndTool, takes_the_base_from_the_sweeps_of_one_target_a_link) {
  for (const unsigned seed : {3U, 4U, 5U}) {
    Random random(seed);
    const Cell cell = test::puma_cell(random, {0, 0, 0});
    const JointVector configuration = random.configuration(cell.arm);
    Log log;
    std::array<Target, 6> targets;
    for (std::size_t i = 0; i < 6; ++i) {
      targets[i].link = i + 1;
      const Vector3 p_L = Vector3(0.2, 0.1, 0.15);
      for (int k = 0; k < 24; ++k) {
        Observation row;
        row.readings = configuration;
        row.readings[i] += 0.1 * k - 1.2;
        row.target = i;
        row.p_S = cell.frame(row.readings, i + 1) * p_L;
        log.push_back(row);
      }
    }
    const auto fitted = fit_base_and_tool(test::puma(), log, targets);
    ASSERT_TRUE(fitted);
    EXPECT_LT(fitted->rms_m, 1e-7);
    // Where joints 1 and 6 are zero is the targets' affair; where their axes are is not.
    const auto axis = [&](const Pose& X_SB) { return Vector3(X_SB.R.col(2)); };
    EXPECT_LT((axis(fitted->X_SB) - axis(cell.X_SB)).norm(), 1e-6);
    for (std::size_t k = 0; k < log.size(); ++k) {
      const Pose X_BL =
          dh_frames(test::puma().joints, log[k].readings)[targets[log[k].target].link];
      EXPECT_LT((log[k].p_S - fitted->X_SB * (X_BL * fitted->p_LT[log[k].target])).norm(), 1e-6);
    }
  }
}

TEST(FitBaseAndTool, refuses_a_log_without_rows_or_targets) {
  for (const bool with_target : {true, false}) {
    const auto targets = one_target();
    const auto fitted =
        fit_base_and_tool(test::puma(), {}, std::span(targets).first(with_target ? 1 : 0));
    ASSERT_FALSE(fitted);
    EXPECT_EQ(test::failure_of(fitted).error, Error::kTooFewPoints);
    EXPECT_EQ(test::failure_of(fitted).found, 0);
  }
}

TEST(FitBaseAndTool, places_targets_on_other_links_and_a_second_one_on_the_last) {
  Random random(2);
  Cell cell = test::puma_cell(random, {0, 0, 0});
  cell.p_tool.emplace_back(-0.1, 0.05, 0.02);
  Log log;
  test::add_poses(cell, 20, 0, random, log);
  const Vector3 p_on_link_2(0.1, 0.2, 0.3);
  for (int k = 0; k < 10; ++k) {
    Observation row;
    row.readings = random.configuration(cell.arm);
    row.target = k % 2 == 0 ? 1 : 2;
    row.p_S =
        row.target == 1 ? cell.point(row.readings, 1) : cell.frame(row.readings, 2) * p_on_link_2;
    log.push_back(row);
  }
  std::array<Target, 3> targets;
  targets[0].link = targets[1].link = 6;
  targets[2].link = 2;
  const auto fitted = fit_base_and_tool(test::puma(), log, targets);
  ASSERT_TRUE(fitted);
  EXPECT_LT((fitted->p_LT[1] - cell.p_tool[1]).norm(), 1e-6);
  EXPECT_LT((fitted->p_LT[2] - p_on_link_2).norm(), 1e-6);
}

TEST(FitBaseAndTool, refuses_what_cannot_be_fitted) {
  Random random(3);
  const Cell cell = test::puma_cell(random);
  Log log;
  test::add_poses(cell, 3, kPoseSigma_m, random, log);
  EXPECT_EQ(test::failure_of(fit_base_and_tool(test::puma(), log, one_target())).error,
            Error::kTooFewPoints);
  test::add_poses(cell, 10, kPoseSigma_m, random, log);
  EXPECT_EQ(test::failure_of(fit_base_and_tool(test::puma(), log, one_target(3))).error,
            Error::kTooFewPoints);

  Log resting(10, log[0]);
  EXPECT_EQ(test::failure_of(fit_base_and_tool(test::puma(), resting, one_target())).error,
            Error::kJointDidNotMove);
  Log stuck = log;
  for (Observation& row : stuck) row.p_S = Vector3(1, 2, 3);
  EXPECT_EQ(test::failure_of(fit_base_and_tool(test::puma(), stuck, one_target())).error,
            Error::kCoincidentPoints);
  log[5].p_S.z() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(test::failure_of(fit_base_and_tool(test::puma(), log, one_target())).found, 5);
}

TEST(FitBaseAndTool, takes_positions_that_are_to_be_fitted_and_no_other_rows) {
  Random random(4);
  const Cell cell = test::puma_cell(random, {0, 0, 0});
  Log log;
  test::add_poses(cell, 40, 0, random, log);
  for (std::size_t k = 0; k < 20; ++k) {
    log[k].p_S = Vector3(std::numeric_limits<double>::quiet_NaN(), 0, 0);
    log[k].use = RowUse::kIgnore;
    if (k % 2 == 0) continue;
    log[k].use = RowUse::kFit;
    log[k].kind = ObservationKind::kRange;
  }
  const auto fitted = fit_base_and_tool(test::puma(), log, one_target());
  ASSERT_TRUE(fitted);
  EXPECT_LT((fitted->p_LT[0] - cell.p_tool[0]).norm(), 1e-6);
  log.resize(23);  // three positions, ten ranges
  const auto few = fit_base_and_tool(test::puma(), log, one_target());
  ASSERT_FALSE(few);
  EXPECT_EQ(test::failure_of(few).error, Error::kTooFewPoints);
  EXPECT_EQ(test::failure_of(few).found, 3);
}

TEST(FitBaseAndTool, leaves_a_target_that_nobody_saw_at_its_links_origin) {
  Random random(5);
  const Cell cell = test::puma_cell(random, {0, 0, 0});
  Log log;
  test::add_poses(cell, 20, 0, random, log);
  std::array<Target, 2> targets;
  targets[0].link = 6;
  targets[1].link = 3;
  const auto fitted = fit_base_and_tool(test::puma(), log, targets);
  ASSERT_TRUE(fitted);
  EXPECT_LT((fitted->p_LT[0] - cell.p_tool[0]).norm(), 1e-6);
  EXPECT_TRUE(fitted->p_LT[1].isZero(0));
}

TEST(FitBaseAndTool, refuses_positions_whose_squares_are_no_numbers) {
  Random random(6);
  const Cell cell = test::puma_cell(random);
  Log log;
  test::add_poses(cell, 20, 0, random, log);
  for (Observation& row : log) row.p_S *= 1e130;
  EXPECT_EQ(test::failure_of(fit_base_and_tool(test::puma(), log, one_target())).error,
            Error::kNotConverged);
}

}  // namespace
}  // namespace armsig::calibration
