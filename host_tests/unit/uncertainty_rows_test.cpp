// SPDX-License-Identifier: MIT
// What each row counts in a check, what a displaced link does to the unknowns, and what features of
// slides know.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "core/base/low_discrepancy.hpp"
#include "core/refinement/determination.hpp"
#include "core/uncertainty/displacement.hpp"
#include "core/uncertainty/drift.hpp"
#include "core/uncertainty/feature_information.hpp"
#include "core/uncertainty/suggestion.hpp"
#include "core/uncertainty/tool_covariance.hpp"
#include "host_tests/support/calibration_case.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::uncertainty {
namespace {

using refinement::Observation;
using refinement::Refined;
using refinement::RowOutcome;
using refinement::RowUse;
using refinement::SquareRootFactor;
using test::Cell;
using test::Log;
using test::Random;

constexpr double kStated_m = 0.2e-3;

struct Checked {
  Random random;
  Cell cell;
  std::unique_ptr<Refined> refined = std::make_unique<Refined>();
  refinement::Receivers receivers{Vector3(2, 0, 0)};
  std::vector<RowOutcome> outcomes;

  explicit Checked(std::uint64_t seed) : random(seed), cell(test::puma_cell(random)) {
    Log log;
    test::add_poses(cell, 60, kStated_m, random, log);
    EXPECT_TRUE(test::calibrate(test::puma(), log, *refined));
  }
  Log poses(int count) {
    Log log;
    test::add_poses(cell, count, kStated_m, random, log);
    return log;
  }
  Judged<DriftReport> check(const Log& log) {
    outcomes.resize(log.size());
    const auto scratch = std::make_unique<SquareRootFactor>();
    return check_drift(*refined, log, receivers, outcomes, *scratch);
  }
};

TEST(CheckDrift, does_not_count_rows_that_are_to_be_ignored) {
  Checked arm(61);
  Log log = arm.poses(40);
  for (std::size_t k = 0; k < 30; ++k) {
    log[k].use = RowUse::kIgnore;
    log[k].p_S.x() += 0.1;
  }
  log[30].p_S.x() += 0.05;  // a blunder beside the others, not beside those that are ignored
  const auto report = arm.check(log);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->verdict, DriftVerdict::kConsistent);
  EXPECT_EQ(report->rows, 9U);
  EXPECT_EQ(report->rows_rejected, 1U);
  EXPECT_GT(arm.outcomes[0].residual_m, 0.05) << "is told all the same";
}

TEST(CheckDrift, counts_of_a_range_one_number) {
  Checked arm(62);
  Log log = arm.poses(30);
  for (Observation& row : log) {
    row.kind = refinement::ObservationKind::kRange;
    row.range_m =
        (arm.cell.point(row.readings, 0) - arm.receivers[0]).norm() + arm.random.normal(kStated_m);
  }
  const auto report = arm.check(log);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->freedom, 30U);
  EXPECT_EQ(report->verdict, DriftVerdict::kConsistent);
}

TEST(CheckDrift, takes_the_sigma_that_was_found_where_a_row_states_none) {
  Checked arm(63);
  Log log = arm.poses(30);
  const auto stated = arm.check(log);
  arm.refined->quality.sigma_m = 2 * kStated_m;
  for (Observation& row : log) row.sigma_m = 0;
  const auto unstated = arm.check(log);
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
    const auto layout = refinement::make_layout(refined.signature, {true, true, false}, {}, 0);
    EXPECT_TRUE(layout);
    refined.layout = *layout;
    refined.information.reset(layout->size());
    for (std::size_t i = 0; i < layout->size(); ++i) refined.information.set_entry(i, i, 1e3);
    displaced_prior(refined, link, kSize, factor);
  }
  // By how much the variance of an unknown has grown, over the square of the displacement's size.
  [[nodiscard]] double growth(std::size_t unknown) const {
    const double sigma = refinement::parameter_sigma(factor, unknown);
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

// A slide and its target, as its sweep gives them.
Signature sliding(Random& random) {
  Signature signature;
  signature.types.push_back(JointType::kPrismatic);
  signature.configuration.push_back(0.1);
  features::JointFeature feature;
  feature.type = JointType::kPrismatic;
  feature.axis_S = random.direction();
  feature.radial_S = any_perpendicular(feature.axis_S);
  feature.point_S = random.normal_vector(1);
  feature.covariance.setZero();
  feature.covariance.diagonal().head<3>().setConstant(4e-8);
  feature.covariance.block<3, 3>(3, 3) =
      1e-6 * (Matrix3::Identity() - feature.axis_S * feature.axis_S.transpose());
  signature.features.push_back(feature);
  Pose X;
  X.R << feature.radial_S, feature.axis_S.cross(feature.radial_S), feature.axis_S;
  X.p = feature.point_S;
  signature.X_SL.push_back(X);
  signature.X_SL.push_back(X);
  Target target;
  target.link = 1;
  target.p_S = feature.target_at(0.1);
  signature.targets.push_back(target);
  return signature;
}

TEST(FromFeatures, of_a_slide_has_the_uncertainty_of_its_line) {
  Random random(65);
  const Signature signature = sliding(random);
  const auto estimate = std::make_unique<Refined>();
  ASSERT_TRUE(from_features(signature, *estimate));
  const double at_rest = tool_covariance(*estimate, {0.1}, 0).trace();
  const double moved = tool_covariance(*estimate, {1.1}, 0).trace();
  // The target is 0.1 m along its line: the tilt moves it by that, and a metre farther on.
  EXPECT_NEAR(at_rest, 3 * 4e-8 + 2 * 0.01 * 1e-6, 0.01 * at_rest);
  EXPECT_NEAR(moved, 3 * 4e-8 + 2 * 1.21 * 1e-6, 0.01 * moved);
}

TEST(FromFeatures, leaves_a_target_that_no_sweep_saw_the_covariance_of_its_own) {
  Random random(66);
  Signature signature = sliding(random);
  signature.targets.push_back(signature.targets[0]);
  signature.targets[0].p_S += Vector3(0.02, 0.03, 0);  // elsewhere on the link
  signature.targets[0].covariance_m2 = 9e-8 * Matrix3::Identity();
  const auto estimate = std::make_unique<Refined>();
  ASSERT_TRUE(from_features(signature, *estimate));
  const Matrix3& found = estimate->signature.targets[0].covariance_m2;
  EXPECT_TRUE(found.isApprox(9e-8 * Matrix3::Identity(), 1e-3));
}

TEST(FromFeatures, refuses_more_targets_than_there_is_room_for) {
  Random random(67);
  Cell cell = test::puma_cell(random);
  cell.arm.joints.push_back({test::kR, 0, 0.1, 0.1, kPi / 2});
  cell.arm.joints.push_back({test::kR, 0, 0.1, 0.1, 0});
  cell.p_tool.resize(kMaxTargets, Vector3(0, 0, 0.1));
  Signature signature = test::signature_of(cell, JointVector(8, 0.3));
  signature.features.resize(8);
  const auto estimate = std::make_unique<Refined>();
  const auto wrapped = from_features(signature, *estimate);
  ASSERT_FALSE(wrapped);
  EXPECT_EQ(test::failure_of(wrapped), Error::kCapacityExceeded);
}

// On the axis nothing says in which direction the radius goes.
TEST(FromFeatures, refuses_a_target_on_the_axis) {
  Random random(68);
  Signature signature = sliding(random);
  features::JointFeature& feature = signature.features[0];
  signature.types[0] = feature.type = JointType::kRevolute;
  feature.radius_m = 1e-3;
  feature.covariance.diagonal() += Eigen::Matrix<double, 7, 1>::Constant(1e-8);
  signature.targets[0].p_S = feature.point_S;
  const auto estimate = std::make_unique<Refined>();
  const auto wrapped = from_features(signature, *estimate);
  ASSERT_FALSE(wrapped);
  EXPECT_EQ(test::failure_of(wrapped), Error::kSingular);
}

// What stands for the work volume is inside; the few candidates that are looked at are not.
TEST(Suggestion, says_where_no_candidate_is_inside_the_box) {
  Checked arm(69);
  const auto search = std::make_unique<SuggestionSearch>();
  SuggestionConfig config;
  config.limits = arm.cell.arm.limits;
  config.candidates = 1;
  const JointVector first = work_configuration(arm.refined->signature.types, config.limits, 1);
  const Vector3 p_S = tool_position(*arm.refined, first, 0);
  config.box = {p_S - Vector3::Constant(1e-3), p_S + Vector3::Constant(1e-3)};
  ASSERT_TRUE(search->start(*arm.refined, config));
  std::vector<Suggestion> suggestions(2);
  const auto suggested = search->suggest(suggestions);
  ASSERT_FALSE(suggested);
  EXPECT_EQ(test::failure_of(suggested), Error::kOutOfReach);
}

}  // namespace
}  // namespace armsig::uncertainty
