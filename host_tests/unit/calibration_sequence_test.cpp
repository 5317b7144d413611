// SPDX-License-Identifier: MIT
// How the estimator comes to its end: from far away, by steps, and with a single joint.
#include <gtest/gtest.h>

#include "host_tests/support/engine_case.hpp"

namespace armsig::calibration {
namespace {

using test::Cell;
using test::EngineCase;
using test::kGeometryAlone;
using test::Random;

// Where the data are exact, sigma is at its floor at once, and only the steps tell whether the fit
// has come to its end.
TEST(EngineSequence, ends_where_steps_no_longer_matter_however_it_is_cut) {
  Random random(61);
  const Cell cell = test::puma_cell(random);
  const Pose far{cell.X_SB.R * rotation_about(Vector3(2, 1, 2) / 3, 0.4),
                 cell.X_SB.p + Vector3(0.2, -0.1, 0.3)};
  const auto rows = test::position_rows(cell, 40, 0, random);
  EngineCase whole(test::puma(), far, {cell.p_tool[0] + Vector3(0.05, 0, 0)}, rows);
  EngineCase cut(test::puma(), far, {cell.p_tool[0] + Vector3(0.05, 0, 0)}, rows);
  const auto summary = whole.engine().run(kGeometryAlone);
  ASSERT_TRUE(summary);
  cut.engine().begin(kGeometryAlone);
  while (cut.engine().step(1)) {
  }
  const auto of_cut = cut.engine().result();
  ASSERT_TRUE(of_cut);
  EXPECT_TRUE(summary->converged);
  EXPECT_EQ(of_cut->rounds, summary->rounds);
  const JointVector other = random.configuration(cell.arm);
  EXPECT_LT((whole.predict(other) - cell.point(other, 0)).norm(), 1e-6);
}

TEST(EngineSequence, finds_the_wave_of_an_arm_of_one_joint) {
  Random random(62);
  const Arm arm = test::make_arm({{test::kR, 0, 0.2, 0.3, 0}}, {{-3, 3}});
  const Cell cell{arm, {random.rotation(), random.direction()}, {Vector3(0.4, 0.1, 0.05)}};
  const auto turned = [](double reading) {
    return reading + radians(0.02) * std::sin(7 * reading);
  };
  std::vector<FitRow> rows;
  for (int k = 0; k < 120; ++k) {
    const double reading = -2.9 + 0.05 * k;
    const Vector3 noise = random.normal_vector(5e-6);
    rows.push_back(test::position_row({reading}, cell.point({turned(reading)}, 0) + noise));
  }
  EngineCase fit(arm, cell.X_SB, {cell.p_tool[0]}, rows);
  ASSERT_TRUE(fit.engine().run({.gravity = false, .maps = true}));
  for (const double reading : {-2.0, -0.7, 0.4, 1.1, 2.3}) {
    EXPECT_LT((fit.predict({reading}) - cell.point({turned(reading)}, 0)).norm(), 2e-5) << reading;
  }
}

}  // namespace
}  // namespace armsig::calibration
