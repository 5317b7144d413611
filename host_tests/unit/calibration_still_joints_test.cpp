// SPDX-License-Identifier: MIT
// Joints that stood still, their readings within the jitter of their servos.
#include <algorithm>

#include <gtest/gtest.h>

#include "host_tests/support/calibration_case.hpp"

namespace armsig::calibration::still_joints {
namespace {

using test::Calibration;
using test::Cell;
using test::Log;
using test::Random;

constexpr double kSigma = 0.1e-3;
constexpr test::Misbehaviour kSagging{.sag_rad_m = 3e-3};
constexpr double kJitter = radians(0.02);
constexpr ModelParts kWithGravity{.gravity = true, .maps = false};

// As drawn, but that it gives way to gravity.
Cell sagging_puma(Random& random) {
  return test::puma_cell(random, {.alpha_rad = 0, .theta_rad = 0, .length_m = 0});
}

calibration::Observation row_at(const Cell& cell, const JointVector& q, double sigma_m,
                                Random& random) {
  calibration::Observation row;
  row.readings = q;
  row.p_S = test::misbehaving_point(cell, q, kSagging) + random.normal_vector(sigma_m);
  return row;
}

// Rows of `moving` joints from `first` on.
Log measured(const Cell& cell, std::size_t first, std::size_t moving, Random& random) {
  Log log;
  for (int k = 0; k < 200; ++k) {
    JointVector q = random.configuration(cell.arm);
    for (std::size_t j = 0; j < q.size(); ++j) {
      const bool moves = j >= first && j < first + moving;
      if (!moves) q[j] = 0.3 + random.uniform(-kJitter, kJitter);
    }
    log.push_back(row_at(cell, q, kSigma, random));
  }
  return log;
}

double mean_error_m(const Calibration& fit, const Cell& cell, Random& random) {
  double sum = 0;
  for (int k = 0; k < 100; ++k) {
    const auto row = row_at(cell, random.configuration(cell.arm), 0, random);
    sum += (row.p_S - fit.predict(row.readings)).norm();
  }
  return sum / 100;
}

bool is_as_drawn(const JointModel& joint) {
  return std::ranges::all_of(joint.deviation, [](double one) { return one == 0; });
}

TEST(StillJoints, beyond_the_last_that_moved_are_as_drawn_and_have_no_gravity) {
  Random random(21);
  const Cell cell = sagging_puma(random);
  Calibration fit(cell.arm, measured(cell, 0, 3, random), kWithGravity);
  ASSERT_TRUE(fit.fit());
  for (std::size_t j = 3; j < 6; ++j) EXPECT_TRUE(is_as_drawn(fit.model().joints[j])) << j;
  EXPECT_EQ(fit.model().joints[2].deviation[4], 0);
  EXPECT_FALSE(fit.model().gravity.empty());
  for (const GravityTerm& term : fit.model().gravity) EXPECT_LT(term.joint, 3);
  EXPECT_LT(mean_error_m(fit, cell, random), 1e-3);
}

TEST(StillJoints, before_the_first_that_moved_are_as_drawn) {
  Random random(22);
  const Cell cell = sagging_puma(random);
  Calibration fit(cell.arm, measured(cell, 2, 4, random), kWithGravity);
  ASSERT_TRUE(fit.fit());
  for (std::size_t j = 0; j < 3; ++j) EXPECT_TRUE(is_as_drawn(fit.model().joints[j])) << j;
}

// What the rows do not tell may be there all the same.
TEST(StillJoints, are_in_doubt_at_other_poses) {
  Random random(23);
  const Cell cell = sagging_puma(random);
  Calibration fit(cell.arm, measured(cell, 0, 3, random), kWithGravity);
  ASSERT_TRUE(fit.fit());
  Engine::Stated there;
  Engine::Stated elsewhere;
  (void)fit.predict(fit.rows()[0].readings, &there);
  (void)fit.predict(random.configuration(cell.arm), &elsewhere);
  EXPECT_GT(elsewhere.model.trace(), 100 * there.model.trace());
}

// A passive joint turns by those that it is coupled to, whatever its reading.
TEST(StillJoints, are_those_whose_axes_do_not_turn) {
  Random random(24);
  Cell cell = sagging_puma(random);
  cell.arm.couplings.push_back({3, 1, -1});
  Log log;
  for (int k = 0; k < 200; ++k) {
    JointVector q = random.configuration(cell.arm);
    q[3] = 0;
    log.push_back(row_at(cell, q, kSigma, random));
  }
  Arm drawing = cell.arm;
  drawing.joints[3].alpha_rad += radians(0.1);
  Calibration fit(drawing, log, kWithGravity);
  ASSERT_TRUE(fit.fit());
  EXPECT_FALSE(is_as_drawn(fit.model().joints[3]));
}

}  // namespace
}  // namespace armsig::calibration::still_joints
