// SPDX-License-Identifier: MIT
#include "core/refinement/square_root_factor.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/lanes.hpp"

namespace armsig::refinement {

namespace {

// Below this sum of squares a column counts as zero: its square root would be lost in underflow,
// and no measurement in SI units comes near it.
constexpr double kVanishing = 1e-280;

// Rows of a block in straight code where several columns go at once; otherwise memory is scarce.
constexpr int kUnrolled = Lanes<double>::kCount > 1 ? 9 : 1;

// Unknowns that are worth a factor of their own.
constexpr std::size_t kNarrow = 16;

// Rotates `block`, of `unknowns` + 1 columns, into the packed factor `r`: leaves zeros and, in the
// last column, the residuals.
template <int kRows>
void rotate(double* r, std::size_t unknowns, RowBlock<kRows>& block) {
  for (std::size_t j = 0; j < unknowns; ++j) {
    const std::size_t width = unknowns + 1 - j;
    std::array<double, kRows> v;
    double squares = 0;
    for (int k = 0; k < kRows; ++k) {
      v[k] = block.rows[k][j];
      squares += v[k] * v[k];
    }
    if (squares > kVanishing) {
      // The reflection that takes (R_jj, v) to (norm, 0). R_jj is never negative, so this form of
      // the first component cannot cancel.
      const double norm = std::sqrt(r[0] * r[0] + squares);
      const double v_0 = -squares / (r[0] + norm);
      const double beta = 2.0 / (v_0 * v_0 + squares);
      r[0] = norm;
      // As many columns at a time as V has lanes.
      const auto reflect = [&]<typename V>(std::size_t c) {
        const V above = load<V>(r + c);
        V dot = v_0 * above;
#pragma GCC unroll kUnrolled
        for (int k = 0; k < kRows; ++k) dot += v[k] * load<V>(&block.rows[k][j + c]);
        dot *= beta;
        store(r + c, above - dot * v_0);
#pragma GCC unroll kUnrolled
        for (int k = 0; k < kRows; ++k) {
          double* below = &block.rows[k][j + c];
          store(below, load<V>(below) - dot * v[k]);
        }
      };
      constexpr std::size_t kLanes = Lanes<double>::kCount;
      std::size_t c = 1;
      for (; c + kLanes <= width; c += kLanes) reflect.template operator()<Pack<double>>(c);
      for (; c < width; ++c) reflect.template operator()<double>(c);
    }
    r += width;
  }
}

}  // namespace

void SquareRootFactor::reset(std::size_t unknowns) {
  ARMSIG_CHECK(unknowns <= kMaxParameters);
  unknowns_ = unknowns;
  residual_squares_ = 0;
  const std::size_t used = row(unknowns);
  for (std::size_t i = 0; i < used; ++i) entries_[i] = 0;
}

template <int kRows>
void SquareRootFactor::absorb(RowBlock<kRows>& block) {
  rotate(entries_.data(), unknowns_, block);
  for (const auto& left : block.rows) residual_squares_ += left[unknowns_] * left[unknowns_];
}

void SquareRootFactor::absorb(std::span<const std::uint8_t> columns, RowBlock<9>& block) {
  const std::size_t count = columns.size();
  if (count > kNarrow || !are_apart(columns)) {
    for (auto& row : block.rows) {
      row[unknowns_] = row[count];
      std::size_t end = unknowns_;
      for (std::size_t i = count; i-- > 0;) {
        const std::size_t column = columns[i];
        row[column] = row[i];
        std::fill(row.begin() + column + 1, row.begin() + end, 0.0);
        end = column;
      }
      std::fill(row.begin(), row.begin() + end, 0.0);
    }
    absorb(block);
    return;
  }
  std::array<double, kNarrow*(kNarrow + 3) / 2> narrow;
  double* next = narrow.data();
  for (std::size_t i = 0; i < count; ++i) {
    const double* r = entries_.data() + row(columns[i]);
    for (std::size_t j = i; j < count; ++j) *next++ = r[columns[j] - columns[i]];
    *next++ = r[unknowns_ - columns[i]];
  }
  rotate(narrow.data(), count, block);
  next = narrow.data();
  for (std::size_t i = 0; i < count; ++i) {
    double* r = entries_.data() + row(columns[i]);
    for (std::size_t j = i; j < count; ++j) r[columns[j] - columns[i]] = *next++;
    r[unknowns_ - columns[i]] = *next++;
  }
  for (const auto& left : block.rows) residual_squares_ += left[count] * left[count];
}

bool SquareRootFactor::are_apart(std::span<const std::uint8_t> columns) const {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const double* r = entries_.data() + row(columns[i]) - columns[i];
    std::size_t listed = i + 1;
    for (std::size_t c = columns[i] + 1U; c < unknowns_; ++c) {
      if (listed < columns.size() && c == columns[listed]) {
        ++listed;
      } else if (r[c] != 0) {
        return false;
      }
    }
  }
  return true;
}

template void SquareRootFactor::absorb<1>(RowBlock<1>&);
template void SquareRootFactor::absorb<2>(RowBlock<2>&);
template void SquareRootFactor::absorb<3>(RowBlock<3>&);
template void SquareRootFactor::absorb<4>(RowBlock<4>&);
template void SquareRootFactor::absorb<9>(RowBlock<9>&);

double SquareRootFactor::solution_squares() const {
  double sum = 0;
  for (std::size_t i = 0; i < unknowns_; ++i) {
    const double z = entry(i, unknowns_);
    sum += z * z;
  }
  return sum;
}

double SquareRootFactor::log_determinant() const {
  double sum = 0;
  for (std::size_t i = 0; i < unknowns_; ++i) sum += std::log(std::abs(entry(i, i)));
  return sum;
}

void SquareRootFactor::scale(double factor) {
  const std::size_t used = row(unknowns_);
  for (std::size_t i = 0; i < used; ++i) entries_[i] *= factor;
  residual_squares_ *= factor * factor;
}

void SquareRootFactor::clear_right_hand_side() {
  for (std::size_t i = 0; i < unknowns_; ++i) set_entry(i, unknowns_, 0);
  residual_squares_ = 0;
}

Result<StateVector> SquareRootFactor::solve() const {
  StateVector x;
  for (std::size_t i = 0; i < unknowns_; ++i) {
    const double diagonal = entry(i, i);
    if (!(diagonal > 0) || !std::isfinite(diagonal)) return std::unexpected(Error::kSingular);
    x[i] = entry(i, unknowns_);
  }
  solve_upper(x);
  for (std::size_t i = 0; i < unknowns_; ++i) {
    if (!std::isfinite(x[i])) return std::unexpected(Error::kSingular);
  }
  return x;
}

void SquareRootFactor::solve_upper(StateVector& z) const {
  for (std::size_t i = unknowns_; i-- > 0;) {
    const double* r = entries_.data() + row(i);
    double sum = z[i];
    for (std::size_t c = i + 1; c < unknowns_; ++c) sum -= r[c - i] * z[c];
    z[i] = sum / r[0];
  }
}

void SquareRootFactor::solve_transposed(StateVector& b, std::size_t first) const {
  for (std::size_t i = first; i < unknowns_; ++i) {
    const double* r = entries_.data() + row(i);
    const double y = b[i] / r[0];
    b[i] = y;
    if (y == 0) continue;
    for (std::size_t c = i + 1; c < unknowns_; ++c) b[c] -= r[c - i] * y;
  }
}

}  // namespace armsig::refinement
