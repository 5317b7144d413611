// SPDX-License-Identifier: MIT
// Recursive least squares in square-root form, the engine of every feature (section 3.2.1 of the
// paper).
//
// Each row of measurements is rotated (Givens) into the triangular factor of the augmented problem:
//
//   [ R  Z ]   R: regressors x regressors, upper triangular     X^T X = R^T R
//   [ 0  E ]   Z: the right-hand sides, rotated alike           coefficients = R^-1 Z
//
// The rows left over are the residuals; only their sums of products E^T E are kept. No matrix is
// ever squared or inverted, so a million updates cost no more digits than ten, in float as in
// double; the covariance form (core/features/rls_covariance.hpp) loses them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/Core>

#include "core/base/error.hpp"
#include "core/base/lanes.hpp"
#include "core/features/triangular_factor.hpp"

namespace armsig::features {

// kRegressors shared by kRightHandSides. Constant memory, no heap; a zero-initialised object knows
// nothing.
template <int kRegressors, int kRightHandSides, typename Scalar = double>
class SquareRootRls {
 public:
  using Regressors = Eigen::Matrix<Scalar, kRegressors, 1>;
  using RightHandSides = Eigen::Matrix<Scalar, kRightHandSides, 1>;
  using Factor = Eigen::Matrix<Scalar, kRegressors, kRegressors>;
  using Coefficients = Eigen::Matrix<Scalar, kRegressors, kRightHandSides>;
  using Products = Eigen::Matrix<Scalar, kRightHandSides, kRightHandSides>;

  // [R Z]: each row over its pivot D^1/2, and D itself in the pivot's place.
  using Row = std::array<Scalar, kRegressors + kRightHandSides>;
  using Kept = std::array<Row, kRegressors>;

  // The upper triangle of E^T E, row by row.
  using KeptProducts = std::array<Scalar, kRightHandSides*(kRightHandSides + 1) / 2>;

  // One measurement: right_hand_sides = coefficients^T * regressors + noise of variance 1 / weight.
  // All numbers must be finite, the weight not negative.
  void update(const Regressors& regressors, const RightHandSides& right_hand_sides,
              Scalar weight = 1) {
    Row row;
    for (int j = 0; j < kRegressors; ++j) row[j] = regressors[j];
    for (int j = 0; j < kRightHandSides; ++j) row[kRegressors + j] = right_hand_sides[j];
    rotate_in(row, weight);
  }

  // Measurements taken in together, column by column: regressors, then right-hand sides, each times
  // the root of its measurement's weight. Rows of zeros are no measurement.
  static constexpr std::size_t kBlockRows = 16;
  using Column = std::array<Scalar, kBlockRows>;
  struct Block {
    alignas(32) std::array<Column, kRegressors + kRightHandSides> columns{};
  };

  // The same as an update by each measurement of `block`, which it destroys, at a fraction of the
  // cost where the processor has lanes: one Householder reflection a regressor, written for the
  // factor as it is kept. With D the pivot's square, u the row, x the block's column of it and y
  // any other, D' = D + x.x and c = sqrt(D / D'):
  //   u' = (D u + x.y) / D',   y' = y - ((1 + c) x.y / x.x - c u) x.
  void update(Block& block) {
    for (int i = 0; i < kRegressors; ++i) {
      const Column& x = block.columns[i];
      const Scalar squares = product(x, x);
      if (!(squares > 0)) continue;
      const Scalar before = factor_[i][i];
      factor_[i][i] += squares;
      const Scalar inverse = 1 / factor_[i][i];
      const Scalar c = std::sqrt(before * inverse);
      const Scalar along = (1 + c) / squares;
      for (int j = i + 1; j < kColumns; ++j) {
        const Scalar above = factor_[i][j];
        const Scalar xy = product(x, block.columns[j]);
        factor_[i][j] = (before * above + xy) * inverse;
        subtract(along * xy - c * above, x, block.columns[j]);
      }
    }
    for (int i = 0, k = 0; i < kRightHandSides; ++i)
      for (int j = i; j < kRightHandSides; ++j, ++k)
        residuals_[k] += product(block.columns[kRegressors + i], block.columns[kRegressors + j]);
  }

  // Measurements that were compressed elsewhere, to `rows` and to the sums of products of the
  // residuals they leave.
  void take_in(const Kept& rows, const KeptProducts& residual_products) {
    if (knows_nothing()) {
      factor_ = rows;
    } else {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        Row row = rows[i];
        Scalar weight = row[i];
        std::fill_n(row.begin(), i, Scalar(0));
        row[i] = 1;
        rotate_in(row, weight);
      }
    }
    for (std::size_t k = 0; k < residuals_.size(); ++k) residuals_[k] += residual_products[k];
  }

  // [R Z] as it is kept.
  [[nodiscard]] const Kept& kept() const { return factor_; }

  // R, upper triangular. Its rows and those of Z stand for all the measurements: feeding them to
  // another estimator, columns permuted or combined, gives the fit of that other model to the same
  // data.
  [[nodiscard]] Factor factor() const {
    Factor R = Factor::Zero();
    for (int i = 0; i < kRegressors; ++i) {
      R(i, i) = std::sqrt(factor_[i][i]);
      for (int j = i + 1; j < kRegressors; ++j) R(i, j) = R(i, i) * factor_[i][j];
    }
    return R;
  }
  [[nodiscard]] Coefficients rotated_right_hand_sides() const {
    Coefficients Z;
    for (int i = 0; i < kRegressors; ++i)
      for (int j = 0; j < kRightHandSides; ++j)
        Z(i, j) = std::sqrt(factor_[i][i]) * factor_[i][kRegressors + j];
    return Z;
  }

  // E^T E: sums of products of the residuals of the least-squares solution.
  [[nodiscard]] Products residual_products() const {
    Products sums;
    for (int i = 0, k = 0; i < kRightHandSides; ++i)
      for (int j = i; j < kRightHandSides; ++j, ++k) sums(i, j) = sums(j, i) = residuals_[k];
    return sums;
  }

  // How many of the regressors the measurements tell apart.
  [[nodiscard]] int rank() const {
    int independent = 0;
    for (int i = 0; i < kRegressors; ++i) independent += is_independent(i) ? 1 : 0;
    return independent;
  }

  // The least-squares coefficients, one column a right-hand side. A regressor that the measurements
  // do not tell from those before it gets the coefficient 0 (a basic solution; complete where
  // rank() is full).
  [[nodiscard]] Coefficients solve() const {
    Coefficients solution = Coefficients::Zero();
    for (int i = kRegressors - 1; i >= 0; --i) {
      if (!is_independent(i)) continue;
      for (int k = 0; k < kRightHandSides; ++k) solution(i, k) = factor_[i][kRegressors + k];
      for (int j = i + 1; j < kRegressors; ++j) solution.row(i) -= factor_[i][j] * solution.row(j);
    }
    return solution;
  }

  // x^T (X^T X)^-1 x: the variance of the prediction at x over that of a measurement of unit
  // weight; infinite where the measurements say nothing about it.
  [[nodiscard]] Scalar prediction_variance(const Regressors& x) const {
    Regressors solved = Regressors::Zero();
    Scalar variance = 0;
    for (int i = 0; i < kRegressors; ++i) {
      Scalar rest = x[i];
      Scalar size = std::abs(x[i]);
      for (int j = 0; j < i; ++j) {
        rest -= factor_[j][i] * solved[j];
        size += std::abs(factor_[j][i] * solved[j]);
      }
      if (is_independent(i)) {
        solved[i] = rest;
        variance += rest * rest / factor_[i][i];
      } else if (std::abs(rest) > kDependent * size) {
        return std::numeric_limits<Scalar>::infinity();
      }
    }
    return variance;
  }

  // R^-1, with R^-1 R^-T the covariance of a column of coefficients for noise of unit variance.
  // Errors: kSingular where the rank is not full.
  [[nodiscard]] Result<Factor> inverse_factor() const {
    if (rank() < kRegressors) return std::unexpected(Error::kSingular);
    Factor inverse = Factor::Zero();
    for (int k = 0; k < kRegressors; ++k) {
      inverse(k, k) = 1 / std::sqrt(factor_[k][k]);
      for (int i = k - 1; i >= 0; --i)
        for (int j = i + 1; j <= k; ++j) inverse(i, k) -= factor_[i][j] * inverse(j, k);
    }
    return inverse;
  }

 private:
  static constexpr int kColumns = kRegressors + kRightHandSides;
  // A pivot this small beside its column is rounding.
  static constexpr Scalar kDependent = 1000 * std::numeric_limits<Scalar>::epsilon();

  void rotate_in(Row& row, Scalar weight) {
    rotate_into(factor_, row, weight);
    for (int i = 0, k = 0; i < kRightHandSides; ++i) {
      const Scalar weighted = weight * row[kRegressors + i];
      for (int j = i; j < kRightHandSides; ++j, ++k)
        residuals_[k] += weighted * row[kRegressors + j];
    }
  }

  static Scalar product(const Column& a, const Column& b) {
    Pack<Scalar> sum{};
#pragma GCC unroll 16
    for (std::size_t k = 0; k < kBlockRows; k += Lanes<Scalar>::kCount)
      sum += load<Pack<Scalar>>(&a[k]) * load<Pack<Scalar>>(&b[k]);
    return sum_of_lanes<Scalar>(sum);
  }
  static void subtract(Scalar factor, const Column& x, Column& from) {
#pragma GCC unroll 16
    for (std::size_t k = 0; k < kBlockRows; k += Lanes<Scalar>::kCount)
      store(&from[k], load<Pack<Scalar>>(&from[k]) - factor * load<Pack<Scalar>>(&x[k]));
  }

  [[nodiscard]] bool knows_nothing() const {
    for (int i = 0; i < kRegressors; ++i)
      if (factor_[i][i] != 0) return false;
    return true;
  }

  [[nodiscard]] bool is_independent(int i) const {
    Scalar column = factor_[i][i];
    for (int j = 0; j < i; ++j) column += factor_[j][j] * factor_[j][i] * factor_[j][i];
    return factor_[i][i] > kDependent * kDependent * column;
  }

  Kept factor_{};
  KeptProducts residuals_{};
};

}  // namespace armsig::features
