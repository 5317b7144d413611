// SPDX-License-Identifier: MIT
// Square-root information filter: a linear least-squares problem that is fed row by row and keeps
// only its upper triangular factor (Bierman, Factorization Methods for Discrete Sequential
// Estimation, 1977, chapter IV). The rows [A | b] of all measurements, each divided by its sigma,
// are reduced to R x = z by Householder reflections; the information matrix R^T R is never formed,
// so half of the digits of the normal equations are not lost.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/base/error.hpp"
#include "core/calibration/parameters.hpp"

namespace armsig::calibration {

inline constexpr std::size_t kMaxColumns = kMaxParameters + 1;  // with the right-hand side

// Some rows of [A | b]; the right-hand side is column n of a problem with n unknowns.
template <int kRows>
struct RowBlock {
  std::array<std::array<double, kMaxColumns>, kRows> rows;

  void clear(std::size_t unknowns) {
    for (auto& row : rows) {
      for (std::size_t c = 0; c <= unknowns; ++c) row[c] = 0;
    }
  }
};

// A vector of one value per unknown.
using StateVector = std::array<double, kMaxParameters>;

class SquareRootFactor {
 public:
  // No information about `unknowns` <= kMaxParameters unknowns.
  void reset(std::size_t unknowns);

  [[nodiscard]] std::size_t unknowns() const { return unknowns_; }

  // Takes rows into the factor; destroys them. The cost depends on the number of unknowns only, and
  // unknowns that the rows do not involve (exact zeros) cost nothing. kRows: 1, 3.
  template <int kRows>
  void absorb(RowBlock<kRows>& block);

  // Sum of the squares that no choice of unknowns can remove, of all rows taken so far.
  [[nodiscard]] double residual_squares() const { return residual_squares_; }
  // Sum of ln |R_ii|: half of the log-determinant of the information.
  [[nodiscard]] double log_determinant() const;

  // Divides the sigma of every row taken so far by `factor`.
  void scale(double factor);

  // The solution of R x = z. kSingular when a diagonal entry is zero or not finite.
  [[nodiscard]] Result<StateVector> solve() const;

  // Replaces b by the solution y of R^T y = b. Preconditions: a factor that solve() accepts, as for
  // all that follow; no number of b before `first` but zeros; as many numbers as unknowns at least.
  void solve_transposed(std::span<double> b, std::size_t first = 0) const;

  // Replaces z by the solution x of R x = z.
  void solve_upper(std::span<double> z) const;

  // b^T (R^T R)^-1 b = |y|^2: the variance of b^T x. Destroys b. Same precondition for `first`.
  [[nodiscard]] double variance(std::span<double> b, std::size_t first = 0) const;

  // J (R^T R)^-1 J^T, the covariance of J x. Leaves R^-T J^T in the rows of `J`.
  [[nodiscard]] Matrix3 covariance(RowBlock<3>& J) const;

  // R_ij, i <= j; column n is z.
  [[nodiscard]] double entry(std::size_t i, std::size_t j) const {
    return entries_[row(i) + j - i];
  }
  void set_entry(std::size_t i, std::size_t j, double value) { entries_[row(i) + j - i] = value; }

 private:
  // Rows one after the other, each from its diagonal entry to its right-hand side.
  [[nodiscard]] std::size_t row(std::size_t i) const {
    return i * (unknowns_ + 1) - i * (i - 1) / 2;
  }

  std::size_t unknowns_ = 0;
  double residual_squares_ = 0;
  std::array<double, kMaxParameters*(kMaxParameters + 3) / 2> entries_{};
};

}  // namespace armsig::calibration
