// SPDX-License-Identifier: MIT
// A signature and its covariance of what the estimator found.
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/low_discrepancy.hpp"
#include "core/calibration/signature_of_model.hpp"
#include "firmware/analysis/starts/determination.hpp"
#include "firmware/analysis/uncertainty/tool_covariance.hpp"
#include "host_tests/support/engine_case.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::calibration {
namespace {

using test::Cell;
using test::EngineCase;
using test::kGeometryAlone;
using test::kRowSigma_m;
using test::position_rows;
using test::Random;

ParameterRequest every_correction(std::size_t joints) {
  ParameterRequest request;
  request.readings.resize(joints, {.gain = true, .first = true, .second = true});
  request.receiver_offsets = true;  // of the receivers that there are
  return request;
}

Judged<void> put_into(EngineCase& fit, Refined& refined, const ParameterRequest& request = {}) {
  std::vector<double> scratch(kMaxParameters * kMaxParameters);
  return geometry_to_signature(*fit.model, fit.targets, fit.engine(), refined, request, scratch);
}

// An arm with a slide, every correction of its readings among the unknowns.
struct Corrected {
  Random random;
  Cell cell;
  EngineCase fit;
  std::unique_ptr<Refined> refined = std::make_unique<Refined>();

  explicit Corrected(std::uint64_t seed)
      : random(seed),
        cell(test::mixed_cell(random)),
        fit(cell.arm, cell.X_SB, {cell.p_tool[0]}, position_rows(cell, 200, kRowSigma_m, random)) {
    fit.model->sensor.receivers.push_back(Vector3(2, 0, 0));
    ask_for(every_correction(6), *fit.model);
    EXPECT_TRUE(fit.engine().run(kGeometryAlone));
    refined->signature = test::signature_of(cell, test::cell_configuration());
    EXPECT_TRUE(put_into(fit, *refined, every_correction(6)));
    for (const JointModel& joint : fit.model->joints) {
      refined->readings.corrections.push_back(joint.correction);
    }
  }
};

TEST(SignatureOfModel, has_of_each_correction_the_variance_that_the_estimator_has) {
  Corrected arm(91);
  const auto& parameters = arm.refined->layout.parameters;
  // A slide has no waves; one receiver.
  ASSERT_EQ(arm.fit.model->further.size(), 6U + 2 * 5 + 2 * 5 + 1);
  std::size_t found = 0;
  for (std::size_t k = 0; k < arm.fit.model->further.size(); ++k) {
    const Parameter& asked = arm.fit.model->further[k];
    std::array<double, kMaxGeometry> unit{};
    unit[arm.fit.engine().further_column() + k] = 1;
    arm.fit.engine().times_covariance(unit);
    const double variance = unit[arm.fit.engine().further_column() + k];
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      if (parameters[i].kind != asked.kind || parameters[i].index != asked.index ||
          parameters[i].component != asked.component) {
        continue;
      }
      ++found;
      const double sigma = parameter_sigma(arm.refined->information, i);
      EXPECT_NEAR(sigma * sigma, variance, 1e-6 * variance) << k;
    }
  }
  EXPECT_EQ(found, arm.fit.model->further.size());
}

TEST(SignatureOfModel, knows_the_tool_as_well_as_the_estimator_does) {
  Corrected arm(92);
  for (int k = 0; k < 5; ++k) {
    const JointVector q = arm.random.configuration(arm.cell.arm);
    const Matrix3 expected =
        arm.fit.engine().covariance_at(arm.fit.frames(q), 0, {1, 0, 0, 1, 0, 1}).model;
    const Matrix3 found = uncertainty::tool_covariance(*arm.refined, q, 0);
    EXPECT_LT((found - expected).norm(), 0.01 * expected.norm()) << k;
    EXPECT_LT((uncertainty::tool_position(*arm.refined, q, 0) - arm.fit.predict(q)).norm(), 1e-6);
  }
}

TEST(SignatureOfModel, leaves_axes_that_stand_as_drawn_and_targets_that_nobody_saw) {
  Random random(93);
  const Cell cell = test::puma_cell(random);
  const Cell drawn{cell.arm, Pose{}, {cell.p_tool[0], Vector3(0, 0, 0.2)}};
  EngineCase fit(cell.arm, Pose{}, drawn.p_tool, {});
  fit.targets[0].rows = 1;
  for (ModelTarget& target : fit.targets) target.p_L += Vector3(0, 0, 0.01);
  const Signature before = test::signature_of(drawn, test::cell_configuration());
  Signature after = before;
  axes_to_signature(*fit.model, fit.targets, after);
  for (std::size_t i = 0; i <= 6; ++i) {
    EXPECT_TRUE(after.X_SL[i].R.isApprox(before.X_SL[i].R, 1e-12)) << i;
    EXPECT_LT((after.X_SL[i].p - before.X_SL[i].p).norm(), 1e-12) << i;
  }
  EXPECT_NEAR((after.targets[0].p_S - before.targets[0].p_S).norm(), 0.01, 1e-12);
  EXPECT_EQ(after.targets[1].p_S, before.targets[1].p_S);
}

TEST(SignatureOfModel, has_no_unknowns_of_a_target_that_nobody_saw) {
  Random random(94);
  Cell cell = test::puma_cell(random);
  EngineCase fit(cell.arm, cell.X_SB, {cell.p_tool[0], Vector3(0, 0, 0.2)},
                 position_rows(cell, 40, kRowSigma_m, random));
  ASSERT_TRUE(fit.engine().run(kGeometryAlone));
  cell.p_tool.emplace_back(0, 0, 0.2);
  const auto refined = std::make_unique<Refined>();
  refined->signature = test::signature_of(cell, test::cell_configuration());
  ASSERT_TRUE(put_into(fit, *refined));
  EXPECT_EQ(refined->layout.size(), 6U * 4 + 3);
  EXPECT_GT(refined->signature.targets[0].covariance_m2.trace(), 0);
  EXPECT_TRUE(refined->signature.targets[1].covariance_m2.isZero(0));
}

TEST(SignatureOfModel, refuses_more_unknowns_than_it_has_room_for) {
  Random random(95);
  Cell cell = test::puma_cell(random);
  cell.arm.joints.push_back({test::kR, 0, 0.1, 0.1, kPi / 2});
  cell.arm.joints.push_back({test::kR, 0, 0.1, 0.1, 0});
  cell.arm.limits.resize(8, {-2, 2});
  cell.p_tool = {Vector3(0, 0, 0.1), Vector3(0, 0.1, 0), Vector3(0.1, 0, 0)};
  EngineCase fit(cell.arm, cell.X_SB, cell.p_tool, position_rows(cell, 40, kRowSigma_m, random));
  ASSERT_TRUE(fit.engine().run(kGeometryAlone));
  const auto refined = std::make_unique<Refined>();
  refined->signature = test::signature_of(cell, JointVector(8, 0.3));
  const auto put = put_into(fit, *refined, every_correction(8));
  ASSERT_FALSE(put);
  EXPECT_EQ(test::failure_of(put).error, Error::kCapacityExceeded);
  EXPECT_EQ(test::failure_of(put).found, 8 * 9 + 3 * 3);
}

TEST(ToolCovariance, has_the_maps_of_the_joints_that_left_the_signatures_configuration) {
  Random random(96);
  const Cell cell = test::mixed_cell(random);
  EngineCase fit(cell.arm, cell.X_SB, {cell.p_tool[0]},
                 position_rows(cell, 150, kRowSigma_m, random));
  ASSERT_TRUE(fit.engine().run({.gravity = false, .maps = true}));
  const auto refined = std::make_unique<Refined>();
  refined->signature = test::signature_of(cell, test::cell_configuration());
  ASSERT_TRUE(put_into(fit, *refined));
  JointVector q = random.configuration(cell.arm);
  q[1] = test::cell_configuration()[1];
  const double without = uncertainty::tool_covariance(*refined, q, 0).trace();
  refined->readings.deflections = fit.model.get();
  const double with = uncertainty::tool_covariance(*refined, q, 0).trace();
  const auto stated = fit.engine().covariance_at(fit.frames(q), 0, {1, 0, 0, 1, 0, 1});
  double expected = 0;
  for (std::size_t j = 0; j < 6; ++j) expected += j == 1 ? 0 : stated.maps[j];
  EXPECT_NEAR(with - without, expected, 0.05 * expected);
}

TEST(PredictedRms, is_that_of_the_tool_over_the_work_volume_with_what_is_unexplained) {
  Corrected arm(97);
  arm.refined->quality.unexplained_m = 1e-4;
  double sum = 0;
  for (int k = 1; k <= 3; ++k) {
    const JointVector q = work_configuration(arm.refined->signature.types, arm.cell.arm.limits, k);
    sum += uncertainty::tool_covariance(*arm.refined, q, 0).trace();
  }
  EXPECT_GT(sum / 3, 3e-8);
  EXPECT_NEAR(uncertainty::predicted_rms(*arm.refined, arm.cell.arm.limits, 0, 3),
              std::sqrt(sum / 3), 1e-12);
}

}  // namespace
}  // namespace armsig::calibration
