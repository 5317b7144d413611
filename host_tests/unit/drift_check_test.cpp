// SPDX-License-Identifier: MIT
// What one check finds of an arm that was identified, what each row counts in it, and what a
// displaced link does to the unknowns.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/drift/check_drift.hpp"
#include "core/drift/displacement.hpp"
#include "firmware/analysis/starts/determination.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/identified_puma.hpp"

namespace armsig::drift {
namespace {

using calibration::Observation;
using calibration::Refined;
using calibration::RowOutcome;
using calibration::RowUse;
using calibration::SquareRootFactor;
using test::Cell;
using test::IdentifiedPuma;
using test::Log;
using test::Random;

constexpr double kSigma_m = IdentifiedPuma::kSigma_m;
const calibration::Receivers kReceivers{Vector3(2, 0, 0)};

Judged<DriftReport> check(const IdentifiedPuma& identified, const Log& log,
                          std::vector<RowOutcome>& outcomes) {
  outcomes.resize(log.size());
  const auto scratch = std::make_unique<SquareRootFactor>();
  return check_drift(*identified.refined, log, kReceivers, outcomes, *scratch);
}

Judged<DriftReport> check(const IdentifiedPuma& identified, const Log& log) {
  std::vector<RowOutcome> outcomes;
  return check(identified, log, outcomes);
}

TEST(CheckDrift, finds_a_healthy_arm_consistent) {
  IdentifiedPuma identified(2);
  Log held_out;
  test::add_poses(identified.cell, 20, kSigma_m, identified.random, held_out);
  std::vector<RowOutcome> outcomes;
  const auto report = check(identified, held_out, outcomes);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->verdict, DriftVerdict::kConsistent);
  EXPECT_EQ(report->freedom, 60U);
  EXPECT_NEAR(report->rms_m, std::sqrt(3.0) * kSigma_m, kSigma_m);
  double largest = 0;
  for (const RowOutcome& row : outcomes) largest = std::max(largest, row.residual_m);
  EXPECT_EQ(report->largest_m, largest);
}

// Far off for its neighbours' sensor, as expected of its own.
TEST(CheckDrift, judges_each_row_by_its_own_sigma) {
  IdentifiedPuma identified(2);
  Log held_out;
  test::add_poses(identified.cell, 10, kSigma_m, identified.random, held_out);
  test::add_poses(identified.cell, 1, 100 * kSigma_m, identified.random, held_out);
  test::add_poses(identified.cell, 10, kSigma_m, identified.random, held_out);
  const auto report = check(identified, held_out);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->rows_rejected, 0U);
  EXPECT_EQ(report->rows, 21U);
}

TEST(CheckDrift, tells_a_moved_base_from_a_worse_sensor) {
  IdentifiedPuma identified(3);
  Log moved;
  test::add_poses(identified.cell, 12, kSigma_m, identified.random, moved);
  for (auto& row : moved) row.p_S += Vector3(1.5e-3, -1e-3, 0.5e-3);
  EXPECT_EQ(check(identified, moved)->verdict, DriftVerdict::kDrifted);
  EXPECT_EQ(check(identified, moved)->link, 0U);

  Log noisy;
  test::add_poses(identified.cell, 12, 4 * kSigma_m, identified.random, noisy);
  for (auto& row : noisy) row.sigma_m = kSigma_m;
  const auto report = check(identified, noisy);
  EXPECT_EQ(report->verdict, DriftVerdict::kSensorWorse);
  EXPECT_NEAR(report->noise_factor, 4, 1.5);
}

TEST(CheckDrift, finds_the_offset_of_one_joint_after_a_crash) {
  IdentifiedPuma identified(4);
  Cell crashed = identified.cell;
  crashed.arm.joints[3].theta_rad += radians(0.3);
  Log log;
  test::add_poses(crashed, 10, kSigma_m, identified.random, log);
  const auto report = check(identified, log);
  EXPECT_EQ(report->verdict, DriftVerdict::kDrifted);
  EXPECT_TRUE(report->link == 3 || report->link == 4) << report->link;
}

TEST(CheckDrift, finds_a_target_that_was_put_back_elsewhere) {
  IdentifiedPuma identified(13);
  Cell changed = identified.cell;
  changed.p_tool[0] += Vector3(0.5e-3, 0.5e-3, 1e-3);
  Log log;
  test::add_poses(changed, 10, kSigma_m, identified.random, log);
  const auto report = check(identified, log);
  EXPECT_EQ(report->verdict, DriftVerdict::kDrifted);
  EXPECT_EQ(report->link, 6U);
}

TEST(CheckDrift, sets_a_blunder_apart) {
  IdentifiedPuma identified(5);
  Log log;
  test::add_poses(identified.cell, 12, kSigma_m, identified.random, log);
  log[7].p_S.x() += 0.05;
  std::vector<RowOutcome> outcomes;
  const auto report = check(identified, log, outcomes);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->verdict, DriftVerdict::kConsistent);
  EXPECT_EQ(report->rows_rejected, 1U);
  EXPECT_TRUE(outcomes[7].rejected);
}

TEST(CheckDrift, refuses_a_log_without_rows_and_numbers_that_are_not_finite) {
  IdentifiedPuma identified(6);
  Log log;
  EXPECT_EQ(test::failure_of(check(identified, log)).error, Error::kTooFewPoints);
  test::add_poses(identified.cell, 3, kSigma_m, identified.random, log);
  log[1].readings[2] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(test::failure_of(check(identified, log)).error, Error::kNotFinite);
  EXPECT_EQ(test::failure_of(check(identified, log)).found, 1);
}

TEST(CheckDrift, refuses_rows_of_which_many_are_blunders) {
  IdentifiedPuma identified(7);
  Log log;
  test::add_poses(identified.cell, 10, kSigma_m, identified.random, log);
  for (std::size_t k = 0; k < 4; ++k) log[k].p_S.x() += 0.5;
  EXPECT_EQ(test::failure_of(check(identified, log)).error, Error::kTooManyOutliers);
}

TEST(CheckDrift, does_not_count_rows_that_are_to_be_ignored) {
  IdentifiedPuma arm(61);
  Log log = arm.poses(40);
  for (std::size_t k = 0; k < 30; ++k) {
    log[k].use = RowUse::kIgnore;
    log[k].p_S.x() += 0.1;
  }
  log[30].p_S.x() += 0.05;  // a blunder beside the others, not beside those that are ignored
  std::vector<RowOutcome> outcomes;
  const auto report = check(arm, log, outcomes);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->verdict, DriftVerdict::kConsistent);
  EXPECT_EQ(report->rows, 9U);
  EXPECT_EQ(report->rows_rejected, 1U);
  EXPECT_GT(outcomes[0].residual_m, 0.05) << "is told all the same";
}

TEST(CheckDrift, counts_of_a_range_one_number) {
  IdentifiedPuma arm(62);
  Log log = arm.poses(30);
  for (Observation& row : log) {
    row.kind = calibration::ObservationKind::kRange;
    row.range_m =
        (arm.cell.point(row.readings, 0) - kReceivers[0]).norm() + arm.random.normal(kSigma_m);
  }
  const auto report = check(arm, log);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->freedom, 30U);
  EXPECT_EQ(report->verdict, DriftVerdict::kConsistent);
}

TEST(CheckDrift, takes_the_sigma_that_was_found_where_a_row_states_none) {
  IdentifiedPuma arm(63);
  Log log = arm.poses(30);
  const auto stated = check(arm, log);
  arm.refined->quality.sigma_m = 2 * kSigma_m;
  for (Observation& row : log) row.sigma_m = 0;
  const auto unstated = check(arm, log);
  ASSERT_TRUE(stated);
  ASSERT_TRUE(unstated);
  EXPECT_LT(unstated->chi_square, 0.5 * stated->chi_square);
}

// Of an arm with a slide, targets on two links and one that nobody saw.
struct Displaced {
  static constexpr double kSize = 0.05;
  Refined refined;
  SquareRootFactor factor;

  explicit Displaced(std::size_t link) {
    Random random(64);
    Cell cell = test::mixed_cell(random);
    cell.p_tool.resize(3, Vector3(0.1, 0.1, 0.1));
    refined.signature = test::signature_of(cell, test::cell_configuration());
    refined.signature.targets[1].link = 1;
    const auto layout = calibration::make_layout(refined.signature, {true, true, false}, {}, 0);
    EXPECT_TRUE(layout);
    refined.layout = *layout;
    refined.information.reset(layout->size());
    for (std::size_t i = 0; i < layout->size(); ++i) refined.information.set_entry(i, i, 1e3);
    displaced_prior(refined, link, kSize, factor);
  }
  // By how much the variance of an unknown has grown, over the square of the displacement's size.
  [[nodiscard]] double growth(std::size_t unknown) const {
    const double sigma = calibration::parameter_sigma(factor, unknown);
    return (sigma * sigma - 1e-6) / (kSize * kSize);
  }
};

TEST(DisplacedPrior, moves_what_is_beyond_the_link_and_nothing_before_it) {
  const Displaced moved(3);
  const auto& layout = moved.refined.layout;
  const Signature& signature = moved.refined.signature;
  for (std::size_t i = 0; i < layout.axis[3]; ++i) EXPECT_NEAR(moved.growth(i), 0, 1e-9) << i;
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_NEAR(moved.growth(layout.axis[3] + c), 1, 1e-6) << "the slide's axis turns";
    EXPECT_NEAR(moved.growth(layout.axis[5] + c), 1, 1e-6);
  }
  const Vector3 r = signature.targets[0].p_S - signature.X_SL[3].p;
  for (std::size_t c = 0; c < 3; ++c) {
    const double lever = r.cross(Vector3::Unit(static_cast<Eigen::Index>(c))).squaredNorm();
    EXPECT_NEAR(moved.growth(layout.target[0] + c), 1 + lever, 1e-6);
    EXPECT_NEAR(moved.growth(layout.target[1] + c), 0, 1e-9) << "on a link before it";
  }
}

}  // namespace
}  // namespace armsig::drift
