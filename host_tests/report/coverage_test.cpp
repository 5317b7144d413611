// SPDX-License-Identifier: MIT
// The expanded uncertainty of a length, against tables and against drawn errors.
#include "firmware/host_tool/report/coverage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/numerics/quantiles.hpp"

namespace armsig::tool {
namespace {

double length_of(const Vector3& variances, double probability = 0.95, double freedom = 0) {
  return coverage_length(UnitLength(freedom), std::array{variances}, probability);
}

// Roots of the 95 % quantiles of chi-square with 3, 2 and 1 degrees of freedom, from tables.
TEST(CoverageLength, is_that_of_tables_in_three_two_and_one_direction) {
  EXPECT_NEAR(length_of({1, 1, 1}), 2.795483, 1e-5);
  EXPECT_NEAR(length_of({1, 1, 0}), 2.447747, 2e-3);
  EXPECT_NEAR(length_of({0, 1, 0}), 1.959964, 4e-3);
  EXPECT_NEAR(length_of({0, 0, 1}), 1.959964, 4e-3);
  EXPECT_NEAR(length_of({1, 1, 1}, 0.99), 3.368214, 1e-5);
}

TEST(CoverageLength, grows_in_proportion_to_the_error) {
  const Vector3 variances(4e-8, 1e-8, 3e-9);
  EXPECT_NEAR(length_of(9 * variances), 3 * length_of(variances), 1e-9);
}

TEST(CoverageLength, is_longer_where_the_noise_was_found_with_few_degrees_of_freedom) {
  for (const double freedom : {3.0, 10.0, 57.0, 8000.0}) {
    const double by_fisher = std::sqrt(numerics::chi_square_quantile(3, 0.05, freedom));
    EXPECT_NEAR(length_of({1, 1, 1}, 0.95, freedom), by_fisher, 1e-4 * by_fisher) << freedom;
  }
}

// Twice the standard uncertainty covers 95 % of one direction and 74 % of three.
TEST(CoverageLength, is_not_twice_the_standard_uncertainty) {
  const UnitLength unit(0);
  EXPECT_NEAR(probability_below(unit, {1, 1, 1}, 2), 0.738536, 1e-5);
  EXPECT_NEAR(probability_below(unit, {1, 1, 1}, 2 * std::sqrt(3.0)), 0.992618, 1e-5);
}

TEST(CoverageLength, holds_the_stated_share_of_drawn_errors_at_poses_unlike_each_other) {
  const std::array<Vector3, 3> poses{Vector3(4, 1, 0.25), Vector3(9, 0.01, 0.04),
                                     Vector3(0.5, 0.5, 0.5)};
  const double length = coverage_length(UnitLength(0), poses, kCoverageProbability);
  std::mt19937_64 random(20);
  std::normal_distribution<double> normal;
  constexpr int kDraws = 400000;
  int within = 0;
  for (int k = 0; k < kDraws; ++k) {
    const Vector3& variances = poses[static_cast<std::size_t>(k) % poses.size()];
    Vector3 error;
    for (int axis = 0; axis < 3; ++axis) error[axis] = std::sqrt(variances[axis]) * normal(random);
    within += error.norm() <= length;
  }
  // Four standard deviations of a share of 400,000 draws.
  EXPECT_NEAR(static_cast<double>(within) / kDraws, 0.95, 0.0014);
}

}  // namespace
}  // namespace armsig::tool
