// SPDX-License-Identifier: MIT
// What holding out poses tells, and what it leaves of the model that it was given.
#include <gtest/gtest.h>

#include "host_tests/support/engine_case.hpp"

namespace armsig::calibration {
namespace {

using test::Cell;
using test::EngineCase;
using test::kGeometryAlone;
using test::kRowSigma_m;
using test::position_rows;
using test::Random;

TEST(HeldOut, begins_every_fold_where_the_model_stood_and_leaves_it_there) {
  Random random(31);
  const Cell cell = test::puma_cell(random);
  EngineCase fit(test::puma(), cell.X_SB, {cell.p_tool[0]},
                 position_rows(cell, 60, kRowSigma_m, random));
  for (JointModel& joint : fit.model->joints) {
    for (double& deviation : joint.deviation) deviation = random.uniform(-1e-4, 1e-4);
  }
  ParameterRequest request;
  request.readings.resize(6, {.gain = true, .first = true});
  ask_for(request, *fit.model);
  for (const Parameter& parameter : fit.model->further) {
    value_of(*fit.model, parameter) = random.uniform(-1e-4, 1e-4);
  }
  const ArmModel before = *fit.model;
  const Vector3 target = fit.targets[0].p_L;
  ASSERT_TRUE(fit.held_out(kGeometryAlone));
  for (std::size_t j = 0; j < 6; ++j) {
    EXPECT_EQ(fit.model->joints[j].deviation, before.joints[j].deviation) << j;
  }
  for (const Parameter& parameter : before.further) {
    EXPECT_EQ(value_of(std::as_const(*fit.model), parameter), value_of(before, parameter));
  }
  EXPECT_EQ(fit.model->X_SB.R, before.X_SB.R);
  EXPECT_EQ(fit.model->X_SB.p, before.X_SB.p);
  EXPECT_EQ(fit.targets[0].p_L, target);
}

TEST(HeldOut, judges_by_the_rows_that_are_no_blunders) {
  Random random(32);
  const Cell cell = test::puma_cell(random);
  std::vector<FitRow> rows = position_rows(cell, 120, kRowSigma_m, random);
  for (std::size_t k = 0; k < 4; ++k) rows[k].p_S += Vector3(0, 0.03, 0);
  EngineCase fit(test::puma(), cell.X_SB, {cell.p_tool[0]}, rows);
  ASSERT_TRUE(fit.engine().run(kGeometryAlone));
  const auto score = fit.held_out(kGeometryAlone);
  ASSERT_TRUE(score);
  EXPECT_EQ(score->rows, 120U);
  EXPECT_EQ(score->rejected, 4U);
  EXPECT_GT(score->largest_m, 0.029);
  EXPECT_LT(score->rms_kept_m, 3 * kRowSigma_m);
  EXPECT_GT(score->rms_m, 0.004);
}

}  // namespace
}  // namespace armsig::calibration
