// SPDX-License-Identifier: MIT
#include <limits>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/calibration/square_root_factor.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
namespace {

constexpr int kUnknowns = 7;

struct Problem {
  Eigen::Matrix<double, 30, kUnknowns> A;
  Eigen::Matrix<double, 30, 1> b;
};

Problem random_problem() {
  test::Random random(1);
  Problem problem;
  for (int r = 0; r < 30; ++r) {
    for (int c = 0; c < kUnknowns; ++c) problem.A(r, c) = random.normal(1);
    problem.b[r] = random.normal(1);
  }
  return problem;
}

template <int kRows>
SquareRootFactor factor_of(const Problem& problem) {
  SquareRootFactor factor;
  factor.reset(kUnknowns);
  for (int r = 0; r < 30; r += kRows) {
    RowBlock<kRows> block;
    block.clear(kUnknowns);
    for (int k = 0; k < kRows && r + k < 30; ++k) {
      for (int c = 0; c < kUnknowns; ++c) block.rows[k][c] = problem.A(r + k, c);
      block.rows[k][kUnknowns] = problem.b[r + k];
    }
    factor.absorb(block);
  }
  return factor;
}

void expect_least_squares(const SquareRootFactor& factor, const Problem& problem) {
  // Independent: Eigen's dense QR of the whole problem.
  const Eigen::VectorXd expected = problem.A.colPivHouseholderQr().solve(problem.b);
  const Result<StateVector> x = factor.solve();
  ASSERT_TRUE(x);
  for (int c = 0; c < kUnknowns; ++c) EXPECT_NEAR((*x)[c], expected[c], 1e-13);
  EXPECT_NEAR(factor.residual_squares(), (problem.A * expected - problem.b).squaredNorm(), 1e-12);
}

TEST(SquareRootFactor, solves_the_least_squares_problem_whatever_the_size_of_its_blocks) {
  const Problem problem = random_problem();
  expect_least_squares(factor_of<1>(problem), problem);
  expect_least_squares(factor_of<3>(problem), problem);
}

TEST(SquareRootFactor, gives_covariances_by_the_transposed_solution) {
  const Problem problem = random_problem();
  const SquareRootFactor factor = factor_of<3>(problem);
  const Eigen::MatrixXd covariance = (problem.A.transpose() * problem.A).inverse();
  StateVector y{};
  y[4] = 1;
  factor.solve_transposed(y);
  double variance = 0;
  for (int c = 0; c < kUnknowns; ++c) variance += y[c] * y[c];
  EXPECT_NEAR(variance, covariance(4, 4), 1e-13);
}

TEST(SquareRootFactor, keeps_the_digits_that_normal_equations_lose) {
  // Laeuchli's matrix: columns (1, e, 0), (1, 0, e). With e = 1e-9, 1 + e^2 rounds to 1 and the
  // normal equations are singular.
  SquareRootFactor factor;
  factor.reset(2);
  const double e = 1e-9;
  for (const auto& row : {std::array<double, 3>{1, 1, 2}, {e, 0, e}, {0, e, e}}) {
    RowBlock<1> block;
    for (int c = 0; c < 3; ++c) block.rows[0][c] = row[c];
    factor.absorb(block);
  }
  const Result<StateVector> x = factor.solve();
  ASSERT_TRUE(x);
  EXPECT_NEAR((*x)[0], 1, 1e-6);
  EXPECT_NEAR((*x)[1], 1, 1e-6);
}

TEST(SquareRootFactor, refuses_to_solve_for_an_unknown_without_information) {
  SquareRootFactor factor;
  factor.reset(2);
  RowBlock<1> block;
  block.clear(2);
  block.rows[0][0] = 1;
  factor.absorb(block);
  EXPECT_EQ(test::failure_of(factor.solve()), Error::kSingular);
}

TEST(SquareRootFactor, log_determinant_is_that_of_its_diagonal) {
  const Problem problem = random_problem();
  const double expected = 0.5 * std::log((problem.A.transpose() * problem.A).determinant());
  EXPECT_NEAR(factor_of<3>(problem).log_determinant(), expected, 1e-12);
}

TEST(SquareRootFactor, scaling_divides_every_sigma) {
  const Problem problem = random_problem();
  SquareRootFactor factor = factor_of<3>(problem);
  const double before = factor.residual_squares();
  const Result<StateVector> x = factor.solve();
  factor.scale(2);
  EXPECT_NEAR(factor.residual_squares(), 4 * before, 1e-12);
  EXPECT_NEAR((*factor.solve())[0], (*x)[0], 1e-14);
}

TEST(SquareRootFactor, refuses_to_solve_where_a_number_is_infinite) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  SquareRootFactor factor;
  factor.reset(2);
  factor.set_entry(0, 0, kInfinite);
  factor.set_entry(1, 1, 1);
  EXPECT_EQ(test::failure_of(factor.solve()), Error::kSingular);
  factor.set_entry(0, 0, 1);
  factor.set_entry(0, 2, kInfinite);
  EXPECT_EQ(test::failure_of(factor.solve()), Error::kSingular);
  factor.set_entry(0, 2, 3);
  EXPECT_TRUE(factor.solve());
}

// The rest of a row set by hand is carried into the rows that follow.
TEST(SquareRootFactor, goes_on_from_entries_that_were_set) {
  SquareRootFactor set;
  SquareRootFactor absorbed;
  set.reset(3);
  absorbed.reset(3);
  RowBlock<1> block;
  const auto absorb = [&](SquareRootFactor& factor, const std::array<double, 4>& row) {
    block.clear(3);
    for (std::size_t c = 0; c < 4; ++c) block.rows[0][c] = row[c];
    factor.absorb(block);
  };
  for (std::size_t i = 0; i < 3; ++i) set.set_entry(i, i, 1);
  set.set_entry(0, 2, 0.5);
  set.set_entry(0, 3, 2);
  absorb(absorbed, {1, 0, 0.5, 2});
  absorb(absorbed, {0, 1, 0, 0});
  absorb(absorbed, {0, 0, 1, 0});
  for (SquareRootFactor* factor : {&set, &absorbed}) absorb(*factor, {3, 0, 0, 1});
  const auto expected = absorbed.solve();
  const auto found = set.solve();
  ASSERT_TRUE(expected);
  ASSERT_TRUE(found);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR((*found)[i], (*expected)[i], 1e-12) << i;
}

}  // namespace
}  // namespace armsig::calibration
