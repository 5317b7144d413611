// SPDX-License-Identifier: MIT
// Recursive least squares in square-root form, the engine of every feature (section 3.2.1 of the
// paper).
//
// Each row of measurements is rotated into the triangular factor of the augmented problem:
//
//   [ R  Z ]   R: regressors x regressors, upper triangular     X^T X = R^T R
//   [ 0  E ]   Z: the right-hand sides, rotated alike           coefficients = R^-1 Z
//
// The rows left over are the residuals; only their sums of products E^T E are kept. No matrix is
// ever squared or inverted, so a million updates cost no more digits than ten, in float as in
// double; the covariance form loses them.
//
// Givens rotations without square roots (Gentleman, "Least squares computations by Givens
// transformations without square roots", J. Inst. Maths Applics 12, 1973), as stable as those with,
// at two thirds of the cost: the factor is kept as R = D^1/2 U, U with a unit diagonal, D in the
// place of that diagonal.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/Core>

#include "core/base/error.hpp"

namespace armsig::features {

// The rotation of a row into one of the factor that makes the row's entry at the pivot vanish; the
// rest of the row is what is left for the next one. One of weight 0 changes nothing.
template <typename Scalar>
struct Rotation {
  Scalar entry;   // of the row, at the pivot
  Scalar square;  // of the pivot, with the row
  Scalar c;
  Scalar s;

  // Of a row of weight `weight`, which becomes that of the rest.
  [[nodiscard]] static Rotation of(Scalar pivot_square, Scalar entry, Scalar& weight) {
    const Scalar weighted = weight * entry;
    const Scalar square = pivot_square + weighted * entry;
    Scalar c = 0;  // nothing is kept yet where the square is 0
    Scalar s = 0;
    if (square > 0) {
      const Scalar inverse = 1 / square;
      c = pivot_square * inverse;
      s = weighted * inverse;
      weight *= c;
    }
    return {entry, square, c, s};
  }
  [[nodiscard]] Scalar rest(Scalar above, Scalar below) const { return below - entry * above; }
  [[nodiscard]] Scalar kept(Scalar above, Scalar below) const { return c * above + s * below; }
};

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
  static constexpr std::size_t kColumns = kRegressors + kRightHandSides;
  using Row = std::array<Scalar, kColumns>;
  using Rows = std::array<Row, kRegressors>;

  // How a measurement stood to those before it.
  struct Innovation {
    RightHandSides residual;  // measured minus predicted
    Scalar leverage;  // the prediction's variance over the measurement's own; infinite where
                      // there was none to speak of
  };

  // The rotations that take a measurement in.
  struct Rotations {
    std::array<Rotation<Scalar>, kRegressors> of_row;
    Rows rows;    // of the measurement, as it comes to each row of the factor
    Scalar left;  // of the weight, for the residual
    Innovation innovation;
  };

  // One measurement: right_hand_sides = coefficients^T * regressors + noise of variance 1 / weight.
  // All numbers must be finite, the weight not negative.
  void update(const Regressors& regressors, const RightHandSides& right_hand_sides,
              Scalar weight = 1) {
    Row row = row_of(regressors, right_hand_sides);
    rotate_in(row, weight);
    add_residual(right_hand_sides_of(row), weight);
  }

  // The same in two steps, for a measurement that is looked at before it is taken in. Its
  // innovation is what the rotations leave: of the row the residual, of the weight so much over
  // 1 + leverage.
  [[nodiscard, gnu::always_inline]] Rotations rotations(const Regressors& regressors,
                                                        const RightHandSides& right_hand_sides,
                                                        Scalar weight) const {
    Row row = row_of(regressors, right_hand_sides);
    Rotations found;
    found.left = weight;
    for (std::size_t i = 0; i < kRegressors; ++i) {
      const auto rotation = Rotation<Scalar>::of(factor_[i][i], row[i], found.left);
      found.of_row[i] = rotation;
      for (std::size_t j = i + 1; j < kColumns; ++j) {
        found.rows[i][j] = row[j];
        row[j] = rotation.rest(factor_[i][j], row[j]);
      }
    }
    found.innovation.residual = right_hand_sides_of(row);
    found.innovation.leverage = weight / found.left - 1;
    return found;
  }
  // Precondition: nothing was taken in between.
  void update(const Rotations& found) {
    for (std::size_t i = 0; i < kRegressors; ++i) {
      const Rotation<Scalar> rotation = found.of_row[i];
      factor_[i][i] = rotation.square;
      for (std::size_t j = i + 1; j < kColumns; ++j)
        factor_[i][j] = rotation.kept(factor_[i][j], found.rows[i][j]);
    }
    add_residual(found.innovation.residual, found.left);
  }

  // One more right-hand side, which the rotations of the measurements take along.
  struct Companion {
    std::array<Scalar, kRegressors> rotated{};         // over the pivots D^1/2, as in Rows
    RightHandSides products = RightHandSides::Zero();  // of its residuals with those of the others
    Scalar square = 0;                                 // of its residuals

    void update(Scalar measured, const Rotations& found) {
      for (std::size_t i = 0; i < kRegressors; ++i) {
        const Scalar above = rotated[i];
        rotated[i] = found.of_row[i].kept(above, measured);
        measured = found.of_row[i].rest(above, measured);
      }
      const Scalar weighted = found.left * measured;
      products += weighted * found.innovation.residual;
      square += weighted * measured;
    }
  };

  // [R Z] as it is kept.
  [[nodiscard]] const Rows& rows() const { return factor_; }

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
    return upper_.template selfadjointView<Eigen::Upper>();
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
  [[nodiscard]] static Row row_of(const Regressors& regressors,
                                  const RightHandSides& right_hand_sides) {
    Row row;
    for (int j = 0; j < kRegressors; ++j) row[j] = regressors[j];
    for (int j = 0; j < kRightHandSides; ++j) row[kRegressors + j] = right_hand_sides[j];
    return row;
  }
  [[nodiscard]] static RightHandSides right_hand_sides_of(const Row& row) {
    return Eigen::Map<const RightHandSides>(row.data() + kRegressors);
  }

  // Rotates `row` into the rows from kPivot on of the factor; `weight` becomes that of the rest. In
  // one pass, a quarter of the instructions of looking first where a compiler keeps no arrays in
  // registers.
  template <std::size_t kPivot = 0>
  [[gnu::always_inline]] void rotate_in(Row& row, Scalar& weight) {
    if constexpr (kPivot < kRegressors) {
      Row& kept = factor_[kPivot];
      const auto rotation = Rotation<Scalar>::of(kept[kPivot], row[kPivot], weight);
      kept[kPivot] = rotation.square;
#pragma GCC unroll 16
      for (std::size_t j = kPivot + 1; j < kColumns; ++j) {
        const Scalar above = kept[j];
        const Scalar below = row[j];
        row[j] = rotation.rest(above, below);
        kept[j] = rotation.kept(above, below);
      }
      rotate_in<kPivot + 1>(row, weight);
    }
  }

  void add_residual(const RightHandSides& residual, Scalar weight) {
    for (int i = 0; i < kRightHandSides; ++i)
      for (int j = i; j < kRightHandSides; ++j) upper_(i, j) += weight * residual[i] * residual[j];
  }

  // A pivot this small beside its column is rounding.
  static constexpr Scalar kDependent = 1000 * std::numeric_limits<Scalar>::epsilon();

  [[nodiscard]] bool is_independent(int i) const {
    Scalar column = factor_[i][i];
    for (int j = 0; j < i; ++j) column += factor_[j][j] * factor_[j][i] * factor_[j][i];
    return factor_[i][i] > kDependent * kDependent * column;
  }

  Rows factor_{};
  Products upper_ = Products::Zero();  // triangle of E^T E
};

}  // namespace armsig::features
