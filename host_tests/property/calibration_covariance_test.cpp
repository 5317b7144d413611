// SPDX-License-Identifier: MIT
// Whoever knows the covariance of a position uses it: noise six times larger across the line of
// sight than along it.
#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "host_tests/support/calibration_case.hpp"

namespace armsig::calibration {
namespace {

using test::Calibration;
using test::Cell;
using test::Random;

constexpr ModelParts kGeometry{.gravity = false, .maps = false};
constexpr double kAlong = 0.01e-3;
constexpr double kAcross = 6 * kAlong;
constexpr double kMeanVariance = (kAlong * kAlong + 2 * kAcross * kAcross) / 3;
constexpr int kScatterArms = 100;
constexpr int kScatterPoses = 60;
constexpr int kScatterPoints = 10;

// The line of sight first.
Matrix3 sight(const Vector3& p_S) {
  Matrix3 axes;
  axes.col(0) = p_S.normalized();
  axes.col(1) = axes.col(0).unitOrthogonal();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

Matrix3 covariance_at(const Vector3& p_S) {
  const Matrix3 axes = sight(p_S);
  const Vector3 variances(kAlong * kAlong, kAcross * kAcross, kAcross * kAcross);
  return axes * variances.asDiagonal() * axes.transpose();
}

// Derivatives of a position by base, target and all deviations, by differences.
Eigen::MatrixXd jacobian(const Calibration& fit, const JointVector& q) {
  ArmModel model = fit.model();
  const Vector3 p_L = fit.target().p_L;
  ChainFrames frames;
  const auto predict = [&] {
    evaluate_chain(model, q, model.joint_count(), frames);
    return Vector3(frames.X_SL * p_L);
  };
  const Vector3 at = predict();
  const auto unknowns = static_cast<Eigen::Index>(9 + kDeviations * model.joint_count());
  Eigen::MatrixXd J(3, unknowns);
  for (Eigen::Index c = 0; c < 3; ++c) {
    J.col(c) = Vector3::Unit(c).cross(at - model.X_SB.p);
    J.col(3 + c) = Vector3::Unit(c);
    J.col(6 + c) = frames.X_SL.R.col(c);
  }
  Eigen::Index column = 9;
  for (JointModel& joint : model.joints) {
    for (double& deviation : joint.deviation) {
      constexpr double kStep = 1e-6;
      deviation += kStep;
      J.col(column++) = (predict() - at) / kStep;
      deviation -= kStep;
    }
  }
  return J;
}

TEST(PositionCovariance, is_used_whole_and_reaches_the_cramer_rao_bound) {
  Vector3 normalised = Vector3::Zero();
  double squares = 0;
  double bound = 0;
  double plain_squares = 0;
  for (int k = 0; k < kScatterArms; ++k) {
    Random random(400 + static_cast<std::uint64_t>(k));
    const Cell cell = test::puma_cell(random);
    test::Log log;
    std::vector<Matrix3> relative;
    for (int p = 0; p < kScatterPoses; ++p) {
      Observation row;
      row.readings = random.configuration(cell.arm);
      const Vector3 p_S = cell.point(row.readings, 0);
      const Vector3 noise(random.normal(kAlong), random.normal(kAcross), random.normal(kAcross));
      row.p_S = p_S + sight(p_S) * noise;
      relative.emplace_back(covariance_at(p_S) / kMeanVariance);
      log.push_back(row);
    }
    Calibration fit(test::puma(), log, kGeometry, relative, kMeanVariance);
    Calibration plain(test::puma(), log, kGeometry);
    ASSERT_TRUE(fit.fit());
    ASSERT_TRUE(plain.fit());
    Eigen::MatrixXd information;
    for (int p = 0; p < kScatterPoses; ++p) {
      const auto row = static_cast<std::size_t>(p);
      const Eigen::MatrixXd J = jacobian(fit, log[row].readings);
      if (p == 0) information = 1e-2 * Eigen::MatrixXd::Identity(J.cols(), J.cols());
      information += J.transpose() * (kMeanVariance * relative[row]).inverse() * J;
    }
    const Eigen::MatrixXd C =
        information.ldlt().solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
    for (int p = 0; p < kScatterPoints; ++p) {
      const JointVector q = random.configuration(cell.arm);
      const Vector3 truth = cell.point(q, 0);
      Engine::Stated stated;
      const Vector3 error = fit.predict(q, &stated) - truth;
      const Matrix3 axes = sight(truth);
      for (Eigen::Index c = 0; c < 3; ++c) {
        const double variance = axes.col(c).dot(stated.model * axes.col(c));
        normalised[c] +=
            std::pow(axes.col(c).dot(error), 2) / variance / (kScatterArms * kScatterPoints);
      }
      const Eigen::MatrixXd J = jacobian(fit, q);
      squares += error.squaredNorm();
      bound += (J * C * J.transpose()).trace();
      plain_squares += (plain.predict(q) - truth).squaredNorm();
    }
  }
  for (Eigen::Index c = 0; c < 3; ++c) {
    EXPECT_GT(normalised[c], 0.85) << c;
    EXPECT_LT(normalised[c], 1.15) << c;
  }
  EXPECT_LT(std::sqrt(squares / bound), 1.05);
  EXPECT_GT(std::sqrt(plain_squares / squares), 1.3);
}

}  // namespace
}  // namespace armsig::calibration
