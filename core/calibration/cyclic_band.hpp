// SPDX-License-Identifier: MIT
// Symmetric positive definite matrices with seven cyclic diagonals: those of a reading map.
#pragma once

#include "core/base/pose.hpp"
#include "core/calibration/reading_map.hpp"

namespace armsig::calibration {

// Row i: entries (i, i), (i, i + 1), (i, i + 2), (i, i + 3), columns modulo kKnots. In single
// precision: it only has to precondition (the gradient is exact), or to state an uncertainty.
using CyclicBand = std::array<std::array<float, kSplines>, kKnots>;

// L L^T of such a matrix: a band, and three full rows at the end where the diagonals come round.
class CyclicFactor {
 public:
  // Of measured / variance + prior / prior_variance, `prior` the stencil of a row. Precondition:
  // `measured` is positive semidefinite, both variances positive.
  void factorise(const CyclicBand& measured, double variance,
                 const std::array<double, kSplines>& prior, double prior_variance);
  // Replaces b by the solution of L L^T x = b.
  void solve(MapCoefficients& b) const;
  // The entries of the inverse that lie on the band, each from those below it on the pattern of L:
  // Takahashi's equations (Erisman and Tinney, Communications of the ACM 18, 1975, 177-179).
  void invert(CyclicBand& band) const;

 private:
  static constexpr std::size_t kBorder = kSplines - 1;
  static constexpr std::size_t kInner = kKnots - kBorder;

  // Of the last three rows and columns of the matrix.
  [[nodiscard]] Matrix3 inverse_of_border() const;

  std::array<std::array<double, kSplines>, kInner> inner_{};  // L(i, i - 3) ... L(i, i)
  std::array<std::array<double, kKnots>, kBorder> border_{};  // rows kInner ...
};

}  // namespace armsig::calibration
