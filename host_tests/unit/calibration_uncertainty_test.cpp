// SPDX-License-Identifier: MIT
// What the estimator says of its own uncertainty, against dense algebra on differences of what it
// predicts.
#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "host_tests/support/dense_prior.hpp"
#include "host_tests/support/engine_case.hpp"

namespace armsig::calibration {
namespace {

using test::Cell;
using test::EngineCase;
using test::Random;

constexpr double kFineSigma_m = 1e-5;
constexpr ModelParts kWithMaps{.gravity = false, .maps = true};
constexpr Eigen::Index kTargetColumn = 6;  // first column of the target

std::vector<FitRow> narrow_positions(const Cell& cell, int poses, std::size_t link,
                                     Random& random) {
  std::vector<FitRow> rows;
  for (int k = 0; k < poses; ++k) {
    JointVector q = random.configuration(cell.arm);
    q[0] *= 0.1;  // so that its map is known here and unknown there
    const Vector3 p_S = cell.frame(q, link) * cell.p_tool[0];
    rows.push_back(test::position_row(q, p_S + random.normal_vector(kFineSigma_m)));
  }
  return rows;
}

// Where the target moves for one unit of joint j's map, everywhere.
Vector3 moved_by_map(EngineCase& fit, const JointVector& q, std::size_t j) {
  constexpr double kStep = 1e-2;
  const Vector3 at = fit.predict(q);
  for (double& c : fit.model->joints[j].map) c += kStep;
  const Vector3 moved = (fit.predict(q) - at) / kStep;
  for (double& c : fit.model->joints[j].map) c -= kStep;
  return moved;
}

Eigen::VectorXd splines_at(const MapDomain& domain, double reading) {
  const SplineSupport at = spline_support(domain, reading);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(kKnots);
  for (std::size_t k = 0; k < kSplines; ++k) {
    b[static_cast<Eigen::Index>(at.knot(k))] += at.weight[k];
  }
  return b;
}

// Of joint j's map in its own units, all else known.
Eigen::MatrixXd map_covariance(EngineCase& fit, std::size_t j) {
  const Scales& scales = fit.engine().scales();
  Eigen::MatrixXd A = test::dense_prior() / scales.map[j];
  for (const FitRow& row : fit.rows) {
    const Eigen::VectorXd b = splines_at(fit.model->joints[j].domain, row.readings[j]);
    const double squares = moved_by_map(fit, row.readings, j).squaredNorm();
    A += row.weight * squares / scales.sigma_squared * b * b.transpose();
  }
  return A.inverse();
}

// Derivatives of a position by base, target and deviations.
Eigen::MatrixXd jacobian(EngineCase& fit, const JointVector& q) {
  const Vector3 at = fit.predict(q);
  Eigen::MatrixXd J(3, static_cast<Eigen::Index>(fit.engine().joint_column(6)));
  for (Eigen::Index c = 0; c < 3; ++c) {
    J.col(c) = Vector3::Unit(c).cross(at - fit.model->X_SB.p);
    J.col(3 + c) = Vector3::Unit(c);
    J.col(kTargetColumn + c) = fit.frames(q).X_SL.R.col(c);
  }
  auto column = static_cast<Eigen::Index>(fit.engine().joint_column(0));
  for (JointModel& joint : fit.model->joints) {
    for (double& deviation : joint.deviation) {
      constexpr double kStep = 1e-6;
      deviation += kStep;
      J.col(column++) = (fit.predict(q) - at) / kStep;
      deviation -= kStep;
    }
  }
  return J;
}

TEST(Uncertainty, of_each_map_is_that_of_its_rows_and_its_prior) {
  Random random(51);
  const Cell cell = test::mixed_cell(random);
  EngineCase fit(cell.arm, cell.X_SB, {cell.p_tool[0]}, narrow_positions(cell, 150, 6, random));
  ASSERT_TRUE(fit.engine().run(kWithMaps));
  const JointVector q = random.configuration(cell.arm);
  const Engine::Stated stated = fit.engine().covariance_at(fit.frames(q), 0, {1, 0, 0, 1, 0, 1});
  for (std::size_t j = 0; j < 6; ++j) {
    const Eigen::MatrixXd C = map_covariance(fit, j);
    const Eigen::VectorXd b = splines_at(fit.model->joints[j].domain, q[j]);
    const double expected = b.dot(C * b) * moved_by_map(fit, q, j).squaredNorm();
    EXPECT_NEAR(stated.maps[j], expected, 0.01 * expected) << j;
    for (std::size_t i = 0; i < kKnots; ++i) {
      Eigen::VectorXd middle = Eigen::VectorXd::Zero(kKnots);
      middle[static_cast<Eigen::Index>((i + kKnots - 1) % kKnots)] = 1.0 / 6;
      middle[static_cast<Eigen::Index>(i)] = 4.0 / 6;
      middle[static_cast<Eigen::Index>((i + 1) % kKnots)] = 1.0 / 6;
      const double variance = middle.dot(C * middle);
      EXPECT_NEAR(static_cast<double>(fit.model->joints[j].map_variance[i]), variance,
                  1e-3 * variance)
          << j << " " << i;
    }
  }
}

TEST(Uncertainty, of_what_a_row_measured_is_that_of_its_place) {
  Random random(52);
  const Cell cell = test::puma_cell(random);
  EngineCase fit(test::puma(), cell.X_SB, {cell.p_tool[0]}, narrow_positions(cell, 60, 6, random));
  fit.model->sensor.receivers.push_back(Vector3(2, 1, 0));
  ASSERT_TRUE(fit.engine().run(test::kGeometryAlone));
  for (int k = 0; k < 4; ++k) {
    const JointVector q = random.configuration(cell.arm);
    const ChainFrames frames = fit.frames(q);
    FitRow row = k % 2 == 0 ? test::position_row(q, cell.point(q, 0))
                            : test::range_row(q, 0, (cell.point(q, 0) - Vector3(2, 1, 0)).norm());
    fit.engine().evaluate(row, frames);
    const Engine::Stated of_row = fit.engine().covariance_of(row, frames);
    const Engine::Stated at = fit.engine().covariance_at(frames, 0, {1, 0, 0, 1, 0, 1});
    EXPECT_LT((of_row.model - at.model).norm(), 1e-9 * at.model.norm()) << k;
    EXPECT_LT((of_row.row - at.row).norm(), 1e-9 * at.row.norm()) << k;
  }
}

// Of J^T W J (J^T W J + prior)^-1 the trace: what an unknown counts that rows and prior hold.
TEST(Uncertainty, counts_of_each_unknown_what_the_rows_determine) {
  Random random(53);
  const Cell cell = test::puma_cell(random);
  EngineCase fit(test::puma(), cell.X_SB, {cell.p_tool[0]}, narrow_positions(cell, 30, 6, random));
  Scales scales;
  scales.rotation = 4;
  scales.shift = 0.01;
  scales.zero = 0.25;
  scales.geometry_is_held = true;
  fit.engine().set_scales(scales);
  const auto summary = fit.engine().run(test::kGeometryAlone);
  ASSERT_TRUE(summary);
  const auto unknowns = static_cast<Eigen::Index>(fit.engine().columns());
  Eigen::MatrixXd told = Eigen::MatrixXd::Zero(unknowns, unknowns);
  for (const FitRow& row : fit.rows) {
    const Eigen::MatrixXd J = jacobian(fit, row.readings);
    told += row.weight * J.transpose() * J / fit.engine().scales().sigma_squared;
  }
  Eigen::VectorXd prior(unknowns);
  prior.head(3).setConstant(1);                    // base: a radian
  prior.segment(3, 6).setConstant(1.0 / (3 * 3));  // base and target: 3 m
  for (Eigen::Index j = 0; j < 6; ++j) {
    auto of_joint = prior.segment(9 + 5 * j, 5);
    of_joint.head(2).setConstant(1 / (4 * 2e-3 * 2e-3));
    of_joint.segment(2, 2).setConstant(1 / (0.01 * 1e-3 * 1e-3));
    of_joint[4] = 1 / (0.25 * 10e-3 * 10e-3);
  }
  const Eigen::MatrixXd whole = told + Eigen::MatrixXd(prior.asDiagonal());
  EXPECT_NEAR(summary->degrees_of_model, whole.ldlt().solve(told).trace(), 0.1);
}

// The same rows, of an arm that is drawn no further than to the link of its target.
TEST(Uncertainty, counts_no_joint_that_does_not_move_the_target) {
  Random random(54);
  const Cell cell = test::puma_cell(random);
  std::vector<FitRow> rows = narrow_positions(cell, 60, 2, random);
  EngineCase whole(test::puma(), cell.X_SB, {cell.p_tool[0]}, rows);
  whole.targets[0].link = 2;
  Arm cut = test::puma();
  cut.joints.resize(2);
  cut.limits.resize(2);
  for (FitRow& row : rows) row.readings.resize(2);
  EngineCase short_one(cut, cell.X_SB, {cell.p_tool[0]}, rows);
  Scales scales;
  scales.geometry_is_held = true;
  whole.engine().set_scales(scales);
  short_one.engine().set_scales(scales);
  const auto of_whole = whole.engine().run(kWithMaps);
  const auto of_short = short_one.engine().run(kWithMaps);
  ASSERT_TRUE(of_whole);
  ASSERT_TRUE(of_short);
  EXPECT_NEAR(of_whole->degrees_of_model, of_short->degrees_of_model, 0.2);
}

}  // namespace
}  // namespace armsig::calibration
