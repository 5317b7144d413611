// SPDX-License-Identifier: MIT
// The searches for base and target of an arm known by its drawing: from anywhere to the minimum.
#include <algorithm>

#include <gtest/gtest.h>

#include "core/base/links.hpp"
#include "firmware/analysis/starts/base_and_targets.hpp"
#include "firmware/analysis/starts/base_and_tool.hpp"
#include "firmware/analysis/starts/cube_rotations.hpp"
#include "firmware/analysis/starts/rotation_search.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
namespace {

using test::Cell;
using test::Log;
using test::Random;

Cell exact_cell(Random& random) { return test::puma_cell(random, {0, 0, 0}); }

Moments moments_of(const Cell& cell, int poses, Random& random) {
  Moments moments;
  for (int k = 0; k < poses; ++k) {
    const JointVector q = random.configuration(cell.arm);
    const Pose X_BL = dh_frames(cell.arm.joints, q).back();
    Vector12 g;
    g << X_BL.p, X_BL.R.col(0), X_BL.R.col(1), X_BL.R.col(2);
    moments.add(cell.point(q, 0), g, 1);
  }
  return moments;
}

TEST(CubeRotations, leave_no_rotation_further_than_63_degrees) {
  Random random(70);
  for (int k = 0; k < 2000; ++k) {
    const Matrix3 R = random.rotation();
    int count = 0;
    double nearest = kPi;
    for_each_cube_rotation([&](const Matrix3& start) {
      ++count;
      nearest = std::min(nearest, angle_between(start, R));
    });
    EXPECT_EQ(count, 24);
    EXPECT_LT(nearest, radians(63));
  }
}

TEST(RotationSearch, ends_in_the_minimum_to_rounding) {
  Random random(71);
  for (int k = 0; k < 10; ++k) {
    const Cell cell = exact_cell(random);
    const Moments moments = moments_of(cell, 12, random);
    const Candidate found = search(moments);
    EXPECT_LT(angle_between(found.R, cell.X_SB.R), 1e-7);
    EXPECT_LT((found.u - cell.p_tool[0]).norm(), 1e-7);
  }
}

TEST(RotationSearch, polishes_a_rough_candidate_to_rounding) {
  Random random(72);
  for (int k = 0; k < 10; ++k) {
    const Cell cell = exact_cell(random);
    Candidate candidate;
    candidate.R = cell.X_SB.R * rotation_about(random.direction(), 0.5);
    candidate.u = cell.p_tool[0] + 0.1 * random.direction();
    polish(moments_of(cell, 12, random), candidate);
    EXPECT_LT(angle_between(candidate.R, cell.X_SB.R), 1e-7);
    EXPECT_LT((candidate.u - cell.p_tool[0]).norm(), 1e-7);
  }
}

// Of an arm that only slides neither the turn about its line nor the target is told.
TEST(RotationSearch, fits_a_straight_line_of_which_the_turn_is_open) {
  for (std::uint64_t seed = 1; seed < 100; ++seed) {
    Random random(seed);
    const Matrix3 R = random.rotation();
    Moments moments;
    for (int k = 0; k < 8; ++k) {
      const Vector3 t(0.1 * k, 0, 0);
      Vector12 g;
      g << t, Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ();
      moments.add(R * t, g, 1);
    }
    Candidate candidate{random.rotation(), random.vector(0.1)};
    EXPECT_LT(polish(moments, candidate), 1e-10) << seed;
    EXPECT_LT((candidate.R.col(0) - R.col(0)).norm(), 1e-5) << seed;
  }
}

// Rows of three targets, one of which was never seen; every so many rows one is a blunder.
struct BlunderedRows {
  BlunderedRows(unsigned seed, int every) {
    Random random(seed);
    cell = exact_cell(random);
    cell.p_tool = {Vector3(0.08, 0.03, 0.12), Vector3(-0.1, 0.1, 0.05), Vector3(0.05, -0.1, 0.1)};
    for (int k = 0; k < 80; ++k) {
      const std::size_t target = k % 2 == 0 ? 0 : 2;
      log.push_back(test::observe(cell, random.configuration(cell.arm), target, 0, random));
      if (k % every == 0) log.back().p_S += 0.3 * random.direction();
    }
    for (Target& target : targets) target.link = 6;
    start.X_SB = {cell.X_SB.R * rotation_about(Vector3(1, 2, 2) / 3, 0.05),
                  cell.X_SB.p + Vector3(0.02, 0.01, -0.03)};
    for (const Vector3& p : cell.p_tool) start.p_LT.push_back(p + Vector3(0.01, -0.02, 0.01));
  }
  BaseAndTargets polished() const {
    BaseAndTargets at = start;
    polish_base_and_targets(DrawnRows(cell.arm, log, targets), at);
    return at;
  }

  Cell cell;
  Log log;
  std::array<Target, 3> targets;
  BaseAndTargets start;
};

TEST(BaseAndTargets, are_polished_past_blunders_and_a_target_without_rows) {
  const BlunderedRows rows(73, 5);
  const BaseAndTargets at = rows.polished();
  EXPECT_LT(angle_between(at.X_SB.R, rows.cell.X_SB.R), 1e-4);
  EXPECT_LT((at.X_SB.p - rows.cell.X_SB.p).norm(), 1e-4);
  EXPECT_LT((at.p_LT[0] - rows.cell.p_tool[0]).norm(), 1e-4);
  EXPECT_LT((at.p_LT[2] - rows.cell.p_tool[2]).norm(), 1e-4);
  EXPECT_EQ(at.p_LT[1], rows.start.p_LT[1]);
}

// Each pass leaves less than half of what the one before left: all twelve are needed.
TEST(BaseAndTargets, are_polished_to_microns_though_half_of_the_rows_are_blunders) {
  const BlunderedRows rows(73, 2);
  EXPECT_LT((rows.polished().X_SB.p - rows.cell.X_SB.p).norm(), 1.7e-6);
}

TEST(FitBaseAndTool, places_as_many_targets_as_there_may_be) {
  Random random(74);
  Cell cell = exact_cell(random);
  std::array<Target, kMaxTargets> targets;
  for (Target& target : targets) {
    target.link = 6;
    cell.p_tool.push_back(0.2 * random.direction());
  }
  cell.p_tool.resize(kMaxTargets);
  Log log;
  test::add_poses(cell, 20, 0, random, log);
  for (std::size_t t = 1; t < kMaxTargets; ++t) {
    for (int k = 0; k < 2; ++k) {
      log.push_back(test::observe(cell, random.configuration(cell.arm), t, 0, random));
    }
  }
  const auto fitted = fit_base_and_tool(cell.arm, log, targets);
  ASSERT_TRUE(fitted);
  for (std::size_t t = 0; t < kMaxTargets; ++t) {
    EXPECT_LT((fitted->p_LT[t] - cell.p_tool[t]).norm(), 1e-6) << t;
  }
}

TEST(Moments, take_no_row_that_has_no_weight) {
  Random random(75);
  const Moments before = moments_of(exact_cell(random), 5, random);
  Moments after = before;
  after.add(Vector3(1e6, 0, 0), Vector12::Constant(1e6), 0);
  EXPECT_EQ(after.weight, before.weight);
  EXPECT_EQ(after.mean_p, before.mean_p);
  Moments none;
  none.add(Vector3(1, 2, 3), Vector12::Ones(), 0);
  EXPECT_EQ(none.weight, 0);
  EXPECT_TRUE(none.mean_p.isZero(0));
}

// Some hundred of them stand for all.
TEST(BaseAndTargets, are_found_from_a_log_of_thousands_of_rows) {
  Random random(76);
  Cell cell = exact_cell(random);
  cell.p_tool = {Vector3(0.08, 0.03, 0.12), Vector3(-0.1, 0.1, 0.05)};
  Log log;
  for (int k = 0; k < 3000; ++k) {
    const auto target = static_cast<std::size_t>(k % 2);
    log.push_back(test::observe(cell, random.configuration(cell.arm), target, 0, random));
  }
  std::array<Target, 2> targets;
  for (Target& target : targets) target.link = 6;
  const BaseAndTargets found = search_base_and_targets(DrawnRows(cell.arm, log, targets), 2);
  EXPECT_LT(angle_between(found.X_SB.R, cell.X_SB.R), 1e-6);
  EXPECT_LT((found.p_LT[1] - cell.p_tool[1]).norm(), 1e-6);
}

}  // namespace
}  // namespace armsig::calibration
