// SPDX-License-Identifier: MIT
// What features of slides know, and what is refused.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "core/base/low_discrepancy.hpp"
#include "firmware/analysis/uncertainty/feature_information.hpp"
#include "firmware/analysis/uncertainty/suggestion.hpp"
#include "firmware/analysis/uncertainty/tool_covariance.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/identified_puma.hpp"

namespace armsig::uncertainty {
namespace {

using calibration::Refined;
using test::Cell;
using test::IdentifiedPuma;
using test::Random;

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
  IdentifiedPuma arm(69);
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
