// SPDX-License-Identifier: MIT
#include "core/refinement/cross_validation.hpp"

#include <gtest/gtest.h>

#include "host_tests/support/refinement_case.hpp"

namespace armsig::refinement {
namespace {

TEST(CrossValidate, scores_poses_by_fits_without_them_and_restores_the_log) {
  Case s = swept_puma(23, kSigma, 50);
  std::vector<RowOutcome> outcomes(s.log.size());
  const auto scratch = std::make_unique<Refined>();
  const auto score = cross_validate(s.start, s.log, {}, outcomes, *scratch);
  ASSERT_TRUE(score);
  EXPECT_EQ(score->rows, 50U);
  // A new measurement is off by its own noise, sqrt(3) sigma, and a little of the model's.
  EXPECT_NEAR(score->rms_m, std::sqrt(3.0) * kSigma, 0.5 * kSigma);
  for (const Observation& row : s.log) EXPECT_EQ(row.use, RowUse::kFit);
}

TEST(CrossValidate, chooses_corrections_only_where_they_help) {
  Case s = swept_puma(24);
  std::vector<RowOutcome> outcomes(120);
  const auto scratch = std::make_unique<Refined>();
  CrossValidation score;
  Log log;
  test::add_poses(s.cell, 120, kSigma, s.random, log);
  const auto ideal = choose_reading_terms(s.start, log, {}, outcomes, *scratch, score);
  ASSERT_TRUE(ideal);
  EXPECT_FALSE(ideal->gain || ideal->first || ideal->second);
  for (Observation& row : log) {
    JointVector q = row.readings;
    for (double& reading : q) reading += 2e-3 * std::cos(reading + 0.4);
    row.p_S = s.cell.point(q, 0) + s.random.normal_vector(kSigma);
  }
  const auto eccentric = choose_reading_terms(s.start, log, {}, outcomes, *scratch, score);
  ASSERT_TRUE(eccentric);
  EXPECT_TRUE(eccentric->first);
}

}  // namespace
}  // namespace armsig::refinement
