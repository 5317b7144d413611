// SPDX-License-Identifier: MIT
// Rows of measurements compressed into a triangular factor by Givens rotations.
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace armsig::features {

// Rotates `row` into the row `kept` of a triangular factor so that row[pivot] vanishes; entries
// before the pivot are taken as zero already.
template <int kColumns, typename Scalar>
inline void rotate_row(Scalar* kept, Scalar* row, int pivot) {
  const Scalar length = std::sqrt(kept[pivot] * kept[pivot] + row[pivot] * row[pivot]);
  if (length == 0) return;
  const Scalar scale = 1 / length;
  const Scalar c = kept[pivot] * scale;
  const Scalar s = row[pivot] * scale;
  kept[pivot] = length;
  for (int j = pivot + 1; j < kColumns; ++j) {
    const Scalar above = kept[j];
    kept[j] = c * above + s * row[j];
    row[j] = c * row[j] - s * above;
  }
}

// R, upper triangular, with R^T R = X^T X for all the rows of X added: whatever least squares can
// say about any linear combination of the columns, its sum of squares included, |X v| = |R v|.
template <int kColumns>
class TriangularFactor {
 public:
  using Row = Eigen::Matrix<double, kColumns, 1>;
  using Matrix = Eigen::Matrix<double, kColumns, kColumns>;

  void add(Row row) {
    for (int i = 0; i < kColumns; ++i) rotate_row<kColumns>(rows_[i], row.data(), i);
  }

  [[nodiscard]] Matrix matrix() const {
    Matrix R = Matrix::Zero();
    for (int i = 0; i < kColumns; ++i)
      for (int j = i; j < kColumns; ++j) R(i, j) = rows_[i][j];
    return R;
  }

 private:
  double rows_[kColumns][kColumns] = {};
};

}  // namespace armsig::features
