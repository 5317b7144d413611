// SPDX-License-Identifier: MIT
// Rows of measurements compressed into a triangular factor by Givens rotations without square roots
// (Gentleman, "Least squares computations by Givens transformations without square roots", J. Inst.
// Maths Applics 12, 1973): as stable as those with, at two thirds of the cost.
//
// The factor is kept as R = D^1/2 U, U with a unit diagonal: D in the place of that diagonal.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>

namespace armsig::features {

// Rotates `row`, of weight `weight`, into row kPivot of the factor, whose pivot's square and
// remaining entries are kept[kPivot] and kept[kPivot + 1...]: row[kPivot] vanishes, the rest of the
// row and its weight are what is left for the next one. A row of weight 0 changes nothing.
template <std::size_t kPivot, typename Scalar, std::size_t kColumns>
inline void rotate_row(std::array<Scalar, kColumns>& kept, std::array<Scalar, kColumns>& row,
                       Scalar& weight) {
  const Scalar x = row[kPivot];
  const Scalar weighted = weight * x;
  const Scalar square = kept[kPivot] + weighted * x;
  if (!(square > 0)) return;
  const Scalar inverse = 1 / square;
  const Scalar c = kept[kPivot] * inverse;
  const Scalar s = weighted * inverse;
  kept[kPivot] = square;
  weight *= c;
#pragma GCC unroll 16
  for (std::size_t j = kPivot + 1; j < kColumns; ++j) {
    const Scalar above = kept[j];
    const Scalar below = row[j];
    row[j] = below - x * above;
    kept[j] = c * above + s * below;
  }
}

// Rotates `row` into the rows from kPivot on of the factor.
template <std::size_t kPivot = 0, typename Scalar, std::size_t kColumns, std::size_t kRows>
inline void rotate_into(std::array<std::array<Scalar, kColumns>, kRows>& factor,
                        std::array<Scalar, kColumns>& row, Scalar& weight) {
  if constexpr (kPivot < kRows) {
    rotate_row<kPivot>(factor[kPivot], row, weight);
    rotate_into<kPivot + 1>(factor, row, weight);
  }
}

// R, upper triangular, with R^T R = X^T W X for all the rows of X added, W their weights: whatever
// least squares can say about any linear combination of the columns, its sum of squares included,
// |W^1/2 X v| = |R v|.
template <int kColumns>
class TriangularFactor {
 public:
  using Row = Eigen::Matrix<double, kColumns, 1>;
  using Matrix = Eigen::Matrix<double, kColumns, kColumns>;

  void add(const Row& columns, double weight = 1) {
    std::array<double, kColumns> row;
    for (int j = 0; j < kColumns; ++j) row[j] = columns[j];
    rotate_into(rows_, row, weight);
  }

  [[nodiscard]] Matrix matrix() const {
    Matrix R = Matrix::Zero();
    for (int i = 0; i < kColumns; ++i) {
      R(i, i) = std::sqrt(rows_[i][i]);
      for (int j = i + 1; j < kColumns; ++j) R(i, j) = R(i, i) * rows_[i][j];
    }
    return R;
  }

 private:
  std::array<std::array<double, kColumns>, kColumns> rows_{};
};

}  // namespace armsig::features
