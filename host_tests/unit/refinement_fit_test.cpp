// SPDX-License-Identifier: MIT
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "core/refinement/compressed_sweep.hpp"
#include "core/refinement/cross_validation.hpp"
#include "core/refinement/refinement.hpp"
#include "core/refinement/robust.hpp"
#include "core/uncertainty/tool_covariance.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::refinement {
namespace {

using test::Cell;
using test::Log;
using test::Random;

constexpr double kSigma = 0.2e-3;

struct Fit {
  std::unique_ptr<Refined> refined = std::make_unique<Refined>();
  std::vector<RowOutcome> outcomes;
  std::expected<void, Refusal> done;
};

Fit fit(const Signature& start, const Log& log, const RefinementConfig& config = {}) {
  Fit result;
  result.outcomes.resize(log.size());
  result.done = refine(start, log, config, result.outcomes, *result.refined);
  return result;
}

double largest_error(const Refined& refined, const Cell& cell) {
  Random random(99);
  double largest = 0;
  for (int k = 0; k < 50; ++k) {
    const JointVector q = random.configuration(cell.arm);
    largest =
        std::max(largest, (uncertainty::tool_position(refined, q, 0) - cell.point(q, 0)).norm());
  }
  return largest;
}

struct Case {
  Random random;
  Cell cell;
  Signature start;
  Log log;
};

Case swept_puma(std::uint64_t seed, double sigma_m = kSigma, int mixed = 0) {
  Random random(seed);
  const Cell cell = test::puma_cell(random);
  const JointVector configuration = test::puma_configuration();
  const Signature start =
      test::disturbed(test::signature_of(cell, configuration), 2e-3, 2e-3, random);
  Log log;
  test::add_sweeps(cell, configuration, kPi, 30, sigma_m, random, log);
  test::add_poses(cell, mixed, sigma_m, random, log);
  return {random, cell, start, log};
}

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

// Four receivers around the arm; poses heard by fewer than three count too.
const Receivers kReceivers{Vector3(2, 0, 0), Vector3(-2, 0.5, 0), Vector3(0, 2.5, 0.2),
                           Vector3(0.3, 0, 3)};

Log ranges_of(const Cell& cell, int poses, double sigma_m, Random& random) {
  Log log;
  for (int k = 0; k < poses; ++k) {
    const JointVector q = random.configuration(cell.arm);
    const std::size_t heard = k % 3 == 0 ? 4 : static_cast<std::size_t>(k % 3);
    for (std::size_t r = 0; r < heard; ++r) {
      Observation row;
      row.kind = ObservationKind::kRange;
      row.receiver = (static_cast<std::size_t>(k) + r) % 4;
      row.readings = q;
      row.range_m = (cell.point(q, 0) - kReceivers[row.receiver]).norm() + random.normal(sigma_m);
      row.sigma_m = kSigma;
      log.push_back(row);
    }
  }
  return log;
}

TEST(Refine, takes_raw_ranges_of_poses_that_one_or_two_receivers_heard) {
  Case s = swept_puma(8);
  RefinementConfig config;
  config.receivers = kReceivers;
  const Fit result = fit(s.start, ranges_of(s.cell, 120, 0, s.random), config);
  ASSERT_TRUE(result.done);
  EXPECT_LT(largest_error(*result.refined, s.cell), 1e-7);
}

TEST(Refine, finds_a_range_offset_per_receiver) {
  Case s = swept_puma(9);
  Log log = ranges_of(s.cell, 150, 0, s.random);
  for (Observation& row : log) row.range_m += 1e-3 * static_cast<double>(row.receiver);
  RefinementConfig config;
  config.receivers = kReceivers;
  config.request.receiver_offsets = true;
  const Fit result = fit(s.start, log, config);
  ASSERT_TRUE(result.done);
  for (std::size_t r = 0; r < 4; ++r) {
    EXPECT_NEAR(result.refined->receiver_offsets_m[r], 1e-3 * static_cast<double>(r), 1e-6);
  }
}

TEST(Refine, refuses_a_scale_from_angles_alone) {
  Case s = swept_puma(10, kSigma, 20);
  RefinementConfig config;
  config.request.scale = true;
  const Fit result = fit(s.start, s.log, config);
  ASSERT_FALSE(result.done);
  EXPECT_EQ(result.done.error().error, Error::kScaleUndetermined);
}

TEST(Refine, finds_the_scale_by_a_prismatic_joint) {
  Random random(11);
  Cell cell = test::puma_cell(random);
  cell.arm.joints[2] = {JointType::kPrismatic, -kPi / 2, 0.3, 0.02, 0};
  cell.arm.limits[2] = {0.1, 0.7};
  JointVector configuration = test::puma_configuration();
  configuration[2] = 0.3;
  Log log;
  test::add_poses(cell, 60, 0, random, log);
  for (Observation& row : log) row.p_S *= 1.004;
  RefinementConfig config;
  config.request.scale = true;
  const Fit result = fit(
      test::disturbed(test::signature_of(cell, configuration), 2e-3, 2e-3, random), log, config);
  ASSERT_TRUE(result.done);
  EXPECT_NEAR(result.refined->scale, 0.004, 1e-7);
}

TEST(Refine, keeps_a_scale_asked_for_with_a_prior_of_its_own) {
  Case s = swept_puma(12, kSigma, 20);
  RefinementConfig config;
  config.request.scale = true;
  config.prior.scale = 1e-4;
  EXPECT_TRUE(fit(s.start, s.log, config).done);
}

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
  EXPECT_EQ(result.done.error().error, Error::kNotFinite);
  EXPECT_EQ(result.done.error().found, 17);
}

TEST(Refine, refuses_fewer_numbers_than_unknowns) {
  Case s = swept_puma(19);
  Log log;
  test::add_poses(s.cell, 8, kSigma, s.random, log);
  const Fit result = fit(s.start, log);
  ASSERT_FALSE(result.done);
  EXPECT_EQ(result.done.error().error, Error::kTooFewPoints);
  EXPECT_EQ(result.done.error().found, 24);
  EXPECT_EQ(result.done.error().needed, 27);
}

TEST(Refine, refuses_poses_that_are_all_equal) {
  Case s = swept_puma(20);
  Log log;
  for (int k = 0; k < 30; ++k) {
    log.push_back(test::observe(s.cell, s.start.configuration, 0, kSigma, s.random));
  }
  EXPECT_EQ(fit(s.start, log).done.error().error, Error::kJointDidNotMove);
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
    EXPECT_TRUE(result.done.error().error == Error::kTooManyOutliers ||
                result.done.error().error == Error::kNotConverged);
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

TEST(CompressSweep, refuses_rows_that_do_not_determine_a_circle) {
  Case s = swept_puma(25);
  std::vector<RowOutcome> outcomes(s.log.size());
  const Chain chain(s.start, {});
  CompressedSweep sweep;
  EXPECT_EQ(sweep_length(s.log, 0, {}), 30U);
  EXPECT_TRUE(compress_sweep(s.log, 0, 30, chain, JointType::kRevolute, outcomes, sweep));
  EXPECT_FALSE(compress_sweep(s.log, 0, 3, chain, JointType::kRevolute, outcomes, sweep));
  for (std::size_t k = 0; k < 30; ++k) s.log[k].readings = s.log[0].readings;
  EXPECT_FALSE(compress_sweep(s.log, 0, 30, chain, JointType::kRevolute, outcomes, sweep));
}

TEST(CompressSweep, leaves_alone_a_sweep_that_carries_another_joint_along) {
  Case s = swept_puma(26);
  ReadingModel readings;
  readings.couplings.push_back({1, 0, 1.0});
  EXPECT_EQ(sweep_length(s.log, 0, readings), 0U);
  EXPECT_EQ(sweep_length(s.log, 30, readings), 30U);
}

TEST(LogHistogram, median_is_within_a_few_per_cent_of_the_sorted_one) {
  Random random(27);
  LogHistogram histogram;
  std::vector<double> values;
  for (int k = 0; k < 1001; ++k) {
    const double v = std::pow(random.normal(1e-3), 2);
    histogram.add(v);
    values.push_back(v);
  }
  std::nth_element(values.begin(), values.begin() + 500, values.end());
  EXPECT_NEAR(histogram.median() / values[500], 1, 0.03);
  EXPECT_EQ(LogHistogram{}.median(), 0);
}

}  // namespace
}  // namespace armsig::refinement
