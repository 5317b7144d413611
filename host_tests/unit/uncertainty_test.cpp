// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <Eigen/Dense>
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
using test::Log;
using test::Random;

constexpr double kSigma_m = IdentifiedPuma::kSigma_m;

TEST(ToolCovariance, grows_away_from_what_was_measured) {
  Random random(1);
  const Cell cell = test::puma_cell(random);
  const JointVector configuration = test::cell_configuration();
  Log log;
  test::add_sweeps(cell, configuration, radians(60), 30, kSigma_m, random, log);
  const auto refined = std::make_unique<Refined>();
  ASSERT_TRUE(test::calibrate(test::puma(), log, *refined));
  JointVector far = configuration;
  for (double& q : far) q += 1.5;
  EXPECT_GT(tool_covariance(*refined, far, 0).trace(),
            10 * tool_covariance(*refined, configuration, 0).trace());
}

TEST(WorkConfiguration, stays_inside_the_limits_and_covers_them_evenly) {
  const JointTypes types(3, JointType::kPrismatic);
  const FixedVector<JointLimits, kMaxJoints> limits{{-1, 2}, {0, 0.5}, {3, 4}};
  std::array<double, 3> mean{};
  for (int k = 1; k <= 1000; ++k) {
    const JointVector q = work_configuration(types, limits, k);
    ASSERT_EQ(q.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_GE(q[i], limits[i].lower);
      EXPECT_LE(q[i], limits[i].upper);
      mean[i] += q[i] / 1000;
    }
  }
  EXPECT_NEAR(mean[0], 0.5, 0.02);
  EXPECT_NEAR(mean[1], 0.25, 0.005);
  EXPECT_NEAR(mean[2], 3.5, 0.01);
}

// The target on a circle as its feature moves: the covariance must be that of the feature itself.
TEST(FromFeatures, gives_the_target_of_one_joint_the_covariance_of_its_feature) {
  Random random(8);
  Signature signature;
  signature.types.push_back(JointType::kRevolute);
  signature.configuration.push_back(0.3);
  features::JointFeature feature;
  feature.axis_S = random.direction();
  feature.radial_S = any_perpendicular(feature.axis_S);
  feature.point_S = random.normal_vector(1);
  feature.radius_m = 0.4;
  feature.reference_reading = -0.2;
  const Eigen::Matrix<double, 7, 7> root =
      1e-4 * Eigen::Matrix<double, 7, 7>::NullaryExpr([&]() { return random.normal(1); });
  feature.covariance = root * root.transpose();
  signature.features.push_back(feature);
  const Matrix3 R =
      (Matrix3() << feature.radial_S, feature.axis_S.cross(feature.radial_S), feature.axis_S)
          .finished();
  // The link frame may sit anywhere along the axis.
  const Pose X{R, feature.point_S + 0.15 * feature.axis_S};
  signature.X_SL.push_back(X);
  signature.X_SL.push_back(X);
  Target target;
  target.number = 1;
  target.link = 1;
  target.p_S = feature.target_at(0.3);
  signature.targets.push_back(target);

  const auto estimate = std::make_unique<Refined>();
  ASSERT_TRUE(from_features(signature, *estimate));
  for (const double reading : {0.3, 1.5, -2.0}) {
    Eigen::Matrix<double, 3, 7> slope;
    constexpr double kStep = 1e-6;
    for (int k = 0; k < 7; ++k) {
      std::array<Vector3, 2> p;
      for (int side = 0; side < 2; ++side) {
        const double h = side == 0 ? -kStep : kStep;
        features::JointFeature moved = feature;
        if (k < 3) moved.point_S[k] += h;
        if (k >= 3 && k < 6) {
          const Matrix3 turn = rotation_about(Vector3::Unit(k - 3), h);
          moved.axis_S = turn * moved.axis_S;
          moved.radial_S = turn * moved.radial_S;
        }
        if (k == 6) moved.radius_m += h;
        p[static_cast<std::size_t>(side)] = moved.target_at(reading);
      }
      slope.col(k) = (p[1] - p[0]) / (2 * kStep);
    }
    const Matrix3 expected = slope * feature.covariance * slope.transpose();
    const Matrix3 found = tool_covariance(*estimate, {reading}, 0);
    EXPECT_LT((found - expected).norm(), 1e-4 * expected.norm()) << "at " << reading;
  }
}

TEST(FromFeatures, refuses_a_feature_without_a_covariance) {
  Random random(9);
  const Cell cell = test::puma_cell(random);
  Signature signature = test::signature_of(cell, test::cell_configuration());
  signature.features.resize(6);
  const auto estimate = std::make_unique<Refined>();
  EXPECT_EQ(test::failure_of(from_features(signature, *estimate)), Error::kSingular);
}

TEST(Suggestion, predicts_the_accuracy_that_the_suggested_poses_then_give) {
  IdentifiedPuma identified(10, 20);
  const auto search = std::make_unique<SuggestionSearch>();
  SuggestionConfig config;
  config.limits = identified.cell.arm.limits;
  config.sigma_m = kSigma_m;
  ASSERT_TRUE(search->start(*identified.refined, config));
  const double before = search->predicted_rms_m();
  std::vector<Suggestion> suggestions(5);
  ASSERT_TRUE(search->suggest(suggestions));
  double last = before;
  for (const Suggestion& suggestion : suggestions) {
    EXPECT_LT(suggestion.predicted_rms_m, last);
    last = suggestion.predicted_rms_m;
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_GE(suggestion.readings[i], config.limits[i].lower);
      EXPECT_LE(suggestion.readings[i], config.limits[i].upper);
    }
  }
  EXPECT_LT(last, 0.8 * before);
}

TEST(Suggestion, stays_inside_the_sensors_box) {
  IdentifiedPuma identified(11, 20);
  const auto search = std::make_unique<SuggestionSearch>();
  SuggestionConfig config;
  config.limits = identified.cell.arm.limits;
  config.box.lower_S = identified.cell.X_SB.p + Vector3(0, -1, -1);
  config.box.upper_S = identified.cell.X_SB.p + Vector3(1, 1, 1);
  ASSERT_TRUE(search->start(*identified.refined, config));
  std::vector<Suggestion> suggestions(4);
  ASSERT_TRUE(search->suggest(suggestions));
  for (const Suggestion& suggestion : suggestions) {
    EXPECT_TRUE(config.box.contains(tool_position(*identified.refined, suggestion.readings, 0)));
  }
}

TEST(Suggestion, says_when_the_box_is_out_of_reach) {
  IdentifiedPuma identified(12, 20);
  const auto search = std::make_unique<SuggestionSearch>();
  SuggestionConfig config;
  config.limits = identified.cell.arm.limits;
  config.box.lower_S = Vector3::Constant(100);
  EXPECT_EQ(test::failure_of(search->start(*identified.refined, config)), Error::kOutOfReach);
}

}  // namespace
}  // namespace armsig::uncertainty
