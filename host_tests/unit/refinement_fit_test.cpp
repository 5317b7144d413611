// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "host_tests/support/refinement_case.hpp"

namespace armsig::refinement {
namespace {

TEST(Refine, is_exact_on_exact_data) {
  Case s = swept_puma(1, 0);
  const Fit result = fit(s.start, s.log);
  ASSERT_TRUE(result.done);
  EXPECT_LT(largest_error(*result.refined, s.cell), 1e-8);
  EXPECT_TRUE(result.refined->undetermined.empty());
}

TEST(Refine, reduced_sweeps_give_the_answer_of_their_rows) {
  Case s = swept_puma(2, kSigma, 20);
  RefinementConfig row_by_row;
  row_by_row.compress_sweeps = false;
  const Fit reduced = fit(s.start, s.log);
  const Fit whole = fit(s.start, s.log, row_by_row);
  ASSERT_TRUE(reduced.done && whole.done);
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const JointVector q = random.configuration(s.cell.arm);
    const Vector3 a = uncertainty::tool_position(*reduced.refined, q, 0);
    const Vector3 b = uncertainty::tool_position(*whole.refined, q, 0);
    EXPECT_LT((a - b).norm(), 1e-9);
    const Matrix3 P = uncertainty::tool_covariance(*reduced.refined, q, 0);
    EXPECT_TRUE(P.isApprox(uncertainty::tool_covariance(*whole.refined, q, 0), 1e-5));
  }
}

TEST(Refine, takes_a_sweep_held_away_from_the_signature_configuration) {
  Case s = swept_puma(4, 0);
  for (std::size_t joint = 0; joint < 6; ++joint) {
    JointVector held = s.start.configuration;
    if (joint < 5) held[5] += 0.7;
    for (int k = 0; k < 10; ++k) {
      JointVector q = held;
      q[joint] += 0.2 * k;
      s.log.push_back(test::observe(s.cell, q, 0, 0, s.random, joint + 1));
    }
  }
  const Fit result = fit(s.start, s.log);
  ASSERT_TRUE(result.done);
  EXPECT_LT(largest_error(*result.refined, s.cell), 1e-8);
}

TEST(Refine, takes_a_sweep_of_a_joint_beyond_the_targets_link_as_a_target_at_rest) {
  Case s = swept_puma(6, 0);
  Target target = s.start.targets[0];
  target.number = 2;
  target.link = 3;
  s.start.targets.push_back(target);
  const Vector3 p_S = target.p_S + Vector3(1e-3, 0, 0);
  for (int k = 0; k < 10; ++k) {
    JointVector q = s.start.configuration;
    q[4] += 0.2 * k;
    s.log.push_back(test::observe(s.cell, q, 0, 0, s.random, 5));
    s.log.back().target = 1;
    s.log.back().p_S = p_S;
  }
  const Fit result = fit(s.start, s.log);
  ASSERT_TRUE(result.done);
  EXPECT_LT((result.refined->signature.targets[1].p_S - p_S).norm(), 1e-8);
  EXPECT_LT(largest_error(*result.refined, s.cell), 1e-8);
}

TEST(Refine, follows_coupled_readings_in_sweeps_and_poses) {
  Case s = swept_puma(5, 0);
  s.cell.arm.couplings.push_back({2, 1, -1.0});
  const JointVector configuration = test::puma_configuration();
  const Signature start =
      test::disturbed(test::signature_of(s.cell, configuration), 2e-3, 2e-3, s.random);
  Log log;
  test::add_sweeps(s.cell, configuration, kPi, 30, 0, s.random, log);
  test::add_poses(s.cell, 10, 0, s.random, log);
  RefinementConfig config;
  config.readings.couplings = s.cell.arm.couplings;
  const Fit result = fit(start, log, config);
  ASSERT_TRUE(result.done);
  EXPECT_LT(largest_error(*result.refined, s.cell), 1e-8);
  EXPECT_EQ(result.refined->quality.rows_rejected, 0U);
}

TEST(Refine, finds_gain_and_eccentricity_of_a_reading) {
  Case s = swept_puma(6, 0);
  ReadingModel truth;
  truth.corrections.resize(6);
  truth.corrections[1] = {0.002, 1e-3, -5e-4, 0, 0};
  truth.corrections[3] = {0, 0, 0, 4e-4, 3e-4};
  Log log;
  test::add_poses(s.cell, 60, 0, s.random, log);
  for (Observation& row : log) {
    JointVector corrected = row.readings;
    for (std::size_t i = 0; i < 6; ++i) corrected[i] = corrected_reading(truth, i, row.readings[i]);
    row.p_S = s.cell.point(corrected, 0);
  }
  RefinementConfig config;
  config.request.readings.resize(6, {true, true, true});
  const Fit result = fit(s.start, log, config);
  ASSERT_TRUE(result.done);
  const auto& found = result.refined->readings.corrections;
  EXPECT_NEAR(found[1].gain, 0.002, 1e-6);
  EXPECT_NEAR(found[1].cos_1, 1e-3, 1e-6);
  EXPECT_NEAR(found[1].sin_1, -5e-4, 1e-6);
  EXPECT_NEAR(found[3].cos_2, 4e-4, 1e-6);
  EXPECT_NEAR(found[3].sin_2, 3e-4, 1e-6);
}

TEST(Refine, refines_an_arm_with_prismatic_joints) {
  Random random(7);
  Cell cell = test::puma_cell(random);
  cell.arm.joints[2] = {JointType::kPrismatic, -kPi / 2, 0.3, 0.02, 0};
  cell.arm.limits[2] = {0.1, 0.7};
  JointVector configuration = test::puma_configuration();
  configuration[2] = 0.3;
  Log log;
  test::add_sweeps(cell, configuration, 0.5, 20, 0, random, log);
  test::add_poses(cell, 20, 0, random, log);
  const Fit result =
      fit(test::disturbed(test::signature_of(cell, configuration), 2e-3, 2e-3, random), log);
  ASSERT_TRUE(result.done);
  EXPECT_LT(largest_error(*result.refined, cell), 1e-8);
}

}  // namespace
}  // namespace armsig::refinement
