// SPDX-License-Identifier: MIT
// What the refinement says of rows: undetermined, gross, without stated noise, contradictory.
#include <limits>

#include <gtest/gtest.h>

#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/refinement_case.hpp"

namespace armsig::refinement {
namespace {

TEST(Refine, names_the_joint_whose_axis_carries_the_target) {
  Random random(13);
  Cell cell = test::puma_cell(random);
  cell.p_tool[0] = Vector3(0, 0, 0.1);
  const Signature start =
      test::disturbed(test::signature_of(cell, test::puma_configuration()), 1e-4, 1e-4, random);
  Log log;
  test::add_poses(cell, 60, kSigma, random, log);
  const Fit result = fit(start, log);
  ASSERT_TRUE(result.done);
  ASSERT_EQ(result.refined->undetermined.size(), 1U);
  EXPECT_EQ(result.refined->undetermined[0].open, Open::kTargetOnAxis);
  EXPECT_EQ(result.refined->undetermined[0].index, 5U);
  // Held near the start, and left wide open in the covariance.
  const Vector3 axis = result.refined->signature.X_SL[5].R.col(2);
  EXPECT_LT(axis.cross(start.X_SL[5].R.col(2)).norm(), 0.01);
}

TEST(Refine, names_a_joint_that_rested) {
  Case s = swept_puma(14);
  Log log;
  for (int k = 0; k < 60; ++k) {
    JointVector q = s.random.configuration(s.cell.arm);
    q[3] = s.start.configuration[3];
    log.push_back(test::observe(s.cell, q, 0, kSigma, s.random));
  }
  const Fit result = fit(s.start, log);
  ASSERT_TRUE(result.done);
  ASSERT_EQ(result.refined->undetermined.size(), 1U);
  EXPECT_EQ(result.refined->undetermined[0].open, Open::kJointAtRest);
  EXPECT_EQ(result.refined->undetermined[0].index, 3U);
}

TEST(Refine, lists_gross_outliers_of_sweeps_and_poses_and_does_not_follow_them) {
  Case s = swept_puma(15, kSigma, 30);
  const Fit clean = fit(s.start, s.log);
  std::vector<bool> spoiled(s.log.size(), false);
  for (std::size_t k = 3; k < s.log.size(); k += 5) {
    s.log[k].p_S += s.random.uniform(5e-3, 0.5) * s.random.direction();
    spoiled[k] = true;
  }
  const Fit result = fit(s.start, s.log);
  ASSERT_TRUE(clean.done && result.done);
  for (std::size_t k = 0; k < s.log.size(); ++k) {
    EXPECT_EQ(result.outcomes[k].rejected, spoiled[k]) << "row " << k;
  }
  EXPECT_LT(largest_error(*result.refined, s.cell), 2 * largest_error(*clean.refined, s.cell));
}

TEST(Refine, finds_the_noise_where_none_is_stated) {
  Case s = swept_puma(16, kSigma, 30);
  for (Observation& row : s.log) row.sigma_m = 0;
  const Fit result = fit(s.start, s.log);
  ASSERT_TRUE(result.done);
  EXPECT_TRUE(result.refined->quality.sigma_is_estimated);
  EXPECT_NEAR(result.refined->quality.sigma_m, kSigma, 0.05 * kSigma);
}

TEST(Refine, enlarges_the_covariance_where_the_stated_noise_is_too_small) {
  Case s = swept_puma(17, kSigma, 30);
  const Fit honest = fit(s.start, s.log);
  for (Observation& row : s.log) row.sigma_m = kSigma / 4;
  const Fit result = fit(s.start, s.log);
  ASSERT_TRUE(honest.done && result.done);
  EXPECT_TRUE(result.refined->quality.covariance_enlarged);
  EXPECT_NEAR(result.refined->quality.noise_factor, 4, 0.2);
  const JointVector q = test::puma_configuration();
  // What the stated noise does not explain may be the arm's own: it is part of the tool's error.
  const double unexplained_m = result.refined->quality.unexplained_m;
  EXPECT_NEAR(unexplained_m, std::sqrt(15.0 / 16) * kSigma, 0.05 * kSigma);
  EXPECT_NEAR(uncertainty::tool_covariance(*result.refined, q, 0).trace() -
                  3 * unexplained_m * unexplained_m,
              uncertainty::tool_covariance(*honest.refined, q, 0).trace(),
              0.1 * uncertainty::tool_covariance(*honest.refined, q, 0).trace());
}

TEST(Refine, names_the_row_that_is_not_finite) {
  Case s = swept_puma(18);
  s.log[17].p_S.y() = std::numeric_limits<double>::quiet_NaN();
  const Fit result = fit(s.start, s.log);
  ASSERT_FALSE(result.done);
  EXPECT_EQ(test::failure_of(result.done).error, Error::kNotFinite);
  EXPECT_EQ(test::failure_of(result.done).found, 17);
}

TEST(Refine, refuses_fewer_numbers_than_unknowns) {
  Case s = swept_puma(19);
  Log log;
  test::add_poses(s.cell, 8, kSigma, s.random, log);
  const Fit result = fit(s.start, log);
  ASSERT_FALSE(result.done);
  EXPECT_EQ(test::failure_of(result.done).error, Error::kTooFewPoints);
  EXPECT_EQ(test::failure_of(result.done).found, 24);
  EXPECT_EQ(test::failure_of(result.done).needed, 27);
}

TEST(Refine, refuses_poses_that_are_all_equal) {
  Case s = swept_puma(20);
  Log log;
  for (int k = 0; k < 30; ++k) {
    log.push_back(test::observe(s.cell, s.start.configuration, 0, kSigma, s.random));
  }
  EXPECT_EQ(test::failure_of(fit(s.start, log).done).error, Error::kJointDidNotMove);
}

TEST(Refine, refuses_rows_that_contradict_each_other) {
  Case s = swept_puma(21);
  Log log;
  test::add_poses(s.cell, 60, kSigma, s.random, log);
  for (std::size_t k = 0; k < log.size(); k += 2) {
    log[k].p_S += s.random.uniform(0.05, 1) * s.random.direction();
  }
  const Fit result = fit(s.start, log);
  if (result.done) {
    // Half against half: what is left must at least be the truth.
    EXPECT_LT(largest_error(*result.refined, s.cell), 5e-3);
  } else {
    EXPECT_TRUE(test::failure_of(result.done).error == Error::kTooManyOutliers ||
                test::failure_of(result.done).error == Error::kNotConverged);
  }
}

TEST(Refine, does_not_fit_rows_that_are_only_scored) {
  Case s = swept_puma(22, kSigma, 40);
  Log without = s.log;
  without.resize(without.size() - 10);
  for (std::size_t k = without.size(); k < s.log.size(); ++k) {
    s.log[k].use = RowUse::kScore;
    s.log[k].p_S += Vector3(1, 0, 0);
  }
  const Fit a = fit(s.start, s.log);
  const Fit b = fit(s.start, without);
  ASSERT_TRUE(a.done && b.done);
  EXPECT_EQ(a.refined->signature.targets[0].p_S, b.refined->signature.targets[0].p_S);
  EXPECT_NEAR(a.outcomes.back().residual_m, 1, 0.01);
}

}  // namespace
}  // namespace armsig::refinement
