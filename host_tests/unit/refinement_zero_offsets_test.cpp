// SPDX-License-Identifier: MIT
// Zeros of the encoders that are not those of the drawing.
#include <gtest/gtest.h>

#include "firmware/analysis/starts/zero_offsets.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
namespace {

using test::Cell;
using test::Log;
using test::Random;

// Those of the first joint and the last are the base's and the target's as well.
void expect_zeros(const JointVector& found, const JointVector& expected, double tolerance) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 1; i + 1 < found.size(); ++i) {
    EXPECT_NEAR(std::remainder(found[i] - expected[i], 2 * kPi), 0, tolerance) << i;
  }
}

Cell shifted(Cell cell, const JointVector& zeros) {
  for (std::size_t i = 0; i < zeros.size(); ++i) {
    DhJoint& row = cell.arm.joints[i];
    (row.type == JointType::kRevolute ? row.theta_rad : row.d_m) += zeros[i];
  }
  return cell;
}

TEST(ZeroOffsets, are_found_to_rounding_by_any_target_on_the_last_link) {
  Random random(101);
  const Cell drawn = test::puma_cell(random, {0, 0, 0});
  const JointVector zeros{0.02, -0.05, 0.04, 0.03, -0.06, 0.01};
  Cell cell = shifted(drawn, zeros);
  cell.p_tool = {Vector3(-0.1, 0.1, 0.05), Vector3(0.08, 0.03, 0.12)};
  Log log;
  for (int k = 0; k < 4; ++k) {
    log.push_back(test::observe(cell, random.configuration(cell.arm), 0, 0, random));
  }
  for (int k = 0; k < 40; ++k) {
    log.push_back(test::observe(cell, random.configuration(cell.arm), 1, 0, random));
  }
  std::array<Target, 2> targets;
  for (Target& target : targets) target.link = 6;
  const auto found = fit_zeros(drawn.arm, log, targets);
  ASSERT_TRUE(found);
  expect_zeros(found->shifts, zeros, 1e-7);
  EXPECT_LT(found->fitted.rms_m, 1e-7);
}

TEST(ZeroOffsets, of_slides_are_found_in_metres) {
  Random random(102);
  const Cell drawn = test::puma_cell(random, {0, 0, 0});
  Cell slides = drawn;
  slides.arm.joints[3].type = JointType::kPrismatic;
  slides.arm.limits[3] = {-0.2, 0.3};
  const JointVector zeros{0.01, 0.03, -0.02, 0.04, 0.05, 0.02};
  const Cell cell = shifted(slides, zeros);
  Log log;
  test::add_poses(cell, 40, 0, random, log);
  const std::array<Target, 1> targets{Target{.number = 1, .link = 6}};
  const auto found = fit_zeros(slides.arm, log, targets);
  ASSERT_TRUE(found);
  EXPECT_LT(found->fitted.rms_m, 1e-6);
  expect_zeros(found->shifts, zeros, 1e-6);
}

// As far away as a radian: steps must be damped where they would go wrong.
void expect_found_a_radian_away(const Arm& drawing, int poses, std::uint64_t seed) {
  Random random(seed);
  Cell drawn = test::puma_cell(random, {0, 0, 0});
  drawn.arm = drawing;
  const std::size_t n = drawing.joints.size();
  JointVector zeros(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) zeros[i] = random.uniform(-1, 1);
  const Cell cell = shifted(drawn, zeros);
  Log log;
  test::add_poses(cell, poses, 0, random, log);
  const std::array<Target, 1> targets{Target{.number = 1, .link = n}};
  const auto found = fit_zeros(drawing, log, targets);
  ASSERT_TRUE(found) << seed;
  expect_zeros(found->shifts, zeros, 1e-6);
}

TEST(ZeroOffsets, are_found_a_radian_away_from_a_dozen_poses) {
  for (std::uint64_t seed = 213; seed < 223; ++seed) {
    expect_found_a_radian_away(test::puma(), 14, seed);
  }
}

TEST(ZeroOffsets, are_found_a_radian_away_of_eight_joints) {
  Arm arm = test::puma();
  arm.joints[5].alpha_rad = -kPi / 2;
  arm.joints.push_back({test::kR, 0, 0.1, 0.1, kPi / 2});
  arm.joints.push_back({test::kR, 0, 0.1, 0.1, 0});
  arm.limits.resize(8, {-2, 2});
  for (std::uint64_t seed = 217; seed < 227; ++seed) expect_found_a_radian_away(arm, 20, seed);
}

// From the zeros drawn the fit ends in another minimum, decimetres away.
TEST(ZeroOffsets, are_found_quarters_of_a_turn_away_with_a_slide_and_without) {
  Random random(1);
  const Cell turning = test::puma_cell(random, {0, 0, 0});
  Cell sliding = turning;
  sliding.arm.joints[3].type = JointType::kPrismatic;
  sliding.arm.limits[3] = {-0.2, 0.3};
  for (const Cell& drawn : {turning, sliding}) {
    for (const double quarters : {1, 2, 3}) {
      const JointVector zeros{0, 0.5 * kPi * quarters, 0.02, 0.01, -0.01, 0};
      Log log;
      test::add_poses(shifted(drawn, zeros), 40, 0, random, log);
      const std::array<Target, 1> targets{Target{.number = 1, .link = 6}};
      const auto found = fit_zeros(drawn.arm, log, targets);
      ASSERT_TRUE(found) << quarters;
      expect_zeros(found->shifts, zeros, 1e-6);
    }
  }
}

TEST(ZeroOffsets, explain_no_points_that_are_of_no_arm) {
  Random random(104);
  const Cell drawn = test::puma_cell(random, {0, 0, 0});
  Log log;
  test::add_poses(drawn, 40, 0, random, log);
  for (Observation& row : log) row.p_S = random.vector(1);
  const std::array<Target, 1> targets{Target{.number = 1, .link = 6}};
  const auto found = fit_zeros(drawn.arm, log, targets);
  ASSERT_TRUE(found);
  EXPECT_GT(found->fitted.rms_m, 0.1);
}

TEST(ZeroOffsets, are_not_sought_in_a_log_without_rows) {
  const std::array<Target, 1> targets{Target{.number = 1, .link = 6}};
  const auto found = fit_zeros(test::puma(), {}, targets);
  ASSERT_FALSE(found);
  EXPECT_EQ(test::failure_of(found).error, Error::kTooFewPoints);
}

}  // namespace
}  // namespace armsig::calibration
