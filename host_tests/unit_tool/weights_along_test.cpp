// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/weights_along.hpp"

#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace armsig::tool {
namespace {

constexpr Eigen::Index kTerms = 5;

// Rows of which each is moved by five weights, along each axis of the base frame.
struct WeighedRows {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(60, 3 * kTerms);
  Eigen::VectorXd moved;

  WeighedRows(const Vector3& up_0, const Eigen::VectorXd& coefficients) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    for (double& entry : J.reshaped()) entry = normal(random);
    Eigen::VectorXd x(3 * kTerms);
    for (Eigen::Index t = 0; t < kTerms; ++t) x.segment<3>(3 * t) = coefficients[t] * up_0;
    moved = J * x;
  }
  [[nodiscard]] WeightsAlong weights() const {
    return {J.transpose() * J, J.transpose() * moved, 1e-12};
  }
};

const Eigen::VectorXd kSoft{{2e-3, 1e-3, 5e-4, -1e-4, 3e-4}};

TEST(WeightsAlong, find_the_vertical_that_made_the_rows) {
  for (const Vector3& up_0 : {Vector3(0, 0, 1), Vector3(-1, 0, 0), Vector3(2, -1, 0.5)}) {
    const Vector3 unit = up_0.normalized();
    const WeighedRows rows(unit, kSoft);
    const auto [found, gain] = rows.weights().best();
    EXPECT_LT((found - unit).norm(), 1e-6);
    EXPECT_NEAR(gain, rows.moved.squaredNorm(), 1e-6 * rows.moved.squaredNorm());
  }
}

// A vertical and its opposite explain the same: joints give way downwards.
TEST(WeightsAlong, stand_so_that_joints_give_way_downwards) {
  const Vector3 up_0 = Vector3(1, 2, 2) / 3;
  const auto [found, gain] = WeighedRows(up_0, -kSoft).weights().best();
  EXPECT_LT((found + up_0).norm(), 1e-6);
}

// Neighbouring origins share one weight in any way, of either sign: what both do together counts.
TEST(WeightsAlong, stand_by_the_deflection_and_not_by_single_coefficients) {
  const Vector3 up_0 = Vector3(1, 2, 2) / 3;
  WeighedRows rows(up_0, kSoft);
  rows.J.middleCols<3>(3) = 0.02 * rows.J.middleCols<3>(3);
  Eigen::VectorXd shared(3 * kTerms);
  const Eigen::VectorXd coefficients{{2e-3, -9e-3, 5e-4, 0, 0}};
  for (Eigen::Index t = 0; t < kTerms; ++t) shared.segment<3>(3 * t) = coefficients[t] * up_0;
  rows.moved = rows.J * shared;
  EXPECT_LT((rows.weights().best().first - up_0).norm(), 1e-3);
}

TEST(WeightsAlong, gain_what_least_squares_along_one_vertical_gains) {
  const WeighedRows rows(Vector3(0.6, 0, 0.8), kSoft);
  const Vector3 up_0 = Vector3::UnitZ();
  Eigen::MatrixXd along(60, kTerms);
  for (Eigen::Index t = 0; t < kTerms; ++t) along.col(t) = rows.J.middleCols<3>(3 * t) * up_0;
  const Eigen::VectorXd c =
      (along.transpose() * along).ldlt().solve(along.transpose() * rows.moved);
  const double expected = rows.moved.squaredNorm() - (rows.moved - along * c).squaredNorm();
  EXPECT_NEAR(rows.weights().gain(up_0), expected, 1e-6 * expected);
}

}  // namespace
}  // namespace armsig::tool
