// SPDX-License-Identifier: MIT
// Rows of measurements compressed into a triangular factor by Givens rotations without square roots
// (Gentleman, "Least squares computations by Givens transformations without square roots", J. Inst.
// Maths Applics 12, 1973): as stable as those with, at two thirds of the cost.
//
// The factor is kept as R = D^1/2 U, U with a unit diagonal: D in the place of that diagonal.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>

#include "core/base/lanes.hpp"

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

// Rows of measurements taken in together, column by column, each times the root of its weight. Rows
// of zeros are no measurement. A multiple of the lanes; without lanes ten columns need no more than
// ten rows, and memory is short.
inline constexpr std::size_t kBlockRows = Lanes<double>::kCount == 1 ? 10 : 12;
template <typename Scalar>
using BlockColumn = std::array<Scalar, kBlockRows>;
template <typename Scalar, std::size_t kColumns>
struct RowBlock {
  alignas(32) std::array<BlockColumn<Scalar>, kColumns> columns{};
};

inline namespace ARMSIG_LANES {

template <typename Scalar>
using BlockPacks = std::array<Pack<Scalar>, kBlockRows / Lanes<Scalar>::kCount>;

template <typename Scalar>
[[nodiscard]] inline BlockPacks<Scalar> packs_of(const BlockColumn<Scalar>& column) {
  const auto* from =
      static_cast<const Scalar*>(__builtin_assume_aligned(column.data(), sizeof(Pack<Scalar>)));
  BlockPacks<Scalar> packs;
#pragma GCC unroll 16
  for (std::size_t k = 0; k < packs.size(); ++k)
    packs[k] = load<Pack<Scalar>>(from + k * Lanes<Scalar>::kCount);
  return packs;
}

template <typename Scalar>
[[nodiscard]] inline Scalar product_of_packs(const BlockPacks<Scalar>& a,
                                             const BlockPacks<Scalar>& b) {
  Pack<Scalar> sum = a[0] * b[0];
#pragma GCC unroll 16
  for (std::size_t k = 1; k < a.size(); ++k) sum += a[k] * b[k];
  return sum_of_lanes<Scalar>(sum);
}

template <typename Scalar>
[[nodiscard]] inline Scalar product(const BlockColumn<Scalar>& a, const BlockColumn<Scalar>& b) {
  return product_of_packs<Scalar>(packs_of(a), packs_of(b));
}

// One column of the block into row `pivot` of the factor: what rotating each of its rows in would
// do, at a fraction of the cost where the processor has lanes. One Householder reflection, written
// for the factor as it is kept: with D the pivot's square, u the row, x the block's column of it
// and y any other, D' = D + x.x and c = sqrt(D / D'):
//   u' = (D u + x.y) / D',   y' = y - ((1 + c) x.y / x.x - c u) x.
template <typename Scalar, std::size_t kColumns>
inline void reflect_column(std::array<Scalar, kColumns>& kept, std::size_t pivot,
                           RowBlock<Scalar, kColumns>& block) {
  const BlockPacks<Scalar> x = packs_of(block.columns[pivot]);
  const auto squares = product_of_packs<Scalar>(x, x);
  if (!(squares > 0)) return;
  const Scalar before = kept[pivot];
  kept[pivot] += squares;
  const Scalar inverse = 1 / kept[pivot];
  const Scalar c = std::sqrt(before * inverse);
  const Scalar along = (1 + c) / squares;
  for (std::size_t j = pivot + 1; j < kColumns; ++j) {
    auto* column = static_cast<Scalar*>(
        __builtin_assume_aligned(block.columns[j].data(), sizeof(Pack<Scalar>)));
    const auto y = [&](std::size_t k) {
      return load<Pack<Scalar>>(column + k * Lanes<Scalar>::kCount);
    };
    Pack<Scalar> sum = x[0] * y(0);
#pragma GCC unroll 16
    for (std::size_t k = 1; k < x.size(); ++k) sum += x[k] * y(k);
    const Scalar above = kept[j];
    const auto xy = sum_of_lanes<Scalar>(sum);
    kept[j] = (before * above + xy) * inverse;
    const Scalar factor = along * xy - c * above;
#pragma GCC unroll 16
    for (std::size_t k = 0; k < x.size(); ++k)
      store(column + k * Lanes<Scalar>::kCount, y(k) - factor * x[k]);
  }
}

}  // namespace ARMSIG_LANES

// R, upper triangular, with R^T R = X^T W X for all the rows of X added, W their weights: whatever
// least squares can say about any linear combination of the columns, its sum of squares included,
// |W^1/2 X v| = |R v|.
//
// Rows gather in a block; while the next one fills, the one before is reflected into the factor, a
// column with each row that is added: every row costs about the same, a third of rotating it in.
template <int kColumns>
class TriangularFactor {
 public:
  using Row = Eigen::Matrix<double, kColumns, 1>;
  using Matrix = Eigen::Matrix<double, kColumns, kColumns>;

  void add(const Row& columns, double weight = 1) {
    if (reflected_ < kWidth) reflect();
    const double root = std::sqrt(weight);
    for (std::size_t j = 0; j < kWidth; ++j)
      blocks_[filling_].columns[j][filled_] = root * columns[static_cast<Eigen::Index>(j)];
    if (++filled_ == kBlockRows) exchange();
  }

  // Takes in what has gathered, so that matrix() need not.
  void compress() {
    while (reflected_ < kWidth) reflect();
    if (filled_ == 0) return;
    for (BlockColumn<double>& column : blocks_[filling_].columns)
      std::fill(column.begin() + filled_, column.end(), 0.0);
    exchange();
    while (reflected_ < kWidth) reflect();
  }

  // At once after compress(), else of a copy.
  [[nodiscard]] Matrix matrix() const {
    return reflected_ == kWidth && filled_ == 0 ? taken_in() : of_a_copy();
  }

 private:
  static constexpr std::size_t kWidth = kColumns;
  static_assert(kWidth <= kBlockRows, "a block is reflected before the next one is full");

  [[nodiscard, gnu::noinline]] Matrix of_a_copy() const {
    TriangularFactor copy = *this;
    copy.compress();
    return copy.taken_in();
  }
  // Of all rows but those that gather.
  [[nodiscard]] Matrix taken_in() const {
    Matrix R = Matrix::Zero();
    for (int i = 0; i < kColumns; ++i) {
      R(i, i) = std::sqrt(rows_[i][i]);
      for (int j = i + 1; j < kColumns; ++j) R(i, j) = R(i, i) * rows_[i][j];
    }
    return R;
  }

  void reflect() {
    reflect_column(rows_[reflected_], reflected_, blocks_[1 - filling_]);
    ++reflected_;
  }
  void exchange() {
    filling_ = 1 - filling_;
    filled_ = 0;
    reflected_ = 0;
  }

  std::array<std::array<double, kWidth>, kWidth> rows_{};
  std::array<RowBlock<double, kWidth>, 2> blocks_{};
  std::size_t filling_ = 0;         // which of the blocks
  std::size_t filled_ = 0;          // rows in it
  std::size_t reflected_ = kWidth;  // columns of the other one that are in the factor
};

}  // namespace armsig::features
