// SPDX-License-Identifier: MIT
#include "core/refinement/square_root_factor.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/lanes.hpp"

namespace armsig::refinement {

namespace {

// Below this sum of squares a column counts as zero: its cube would be lost in underflow, and no
// measurement in SI units comes near it.
constexpr double kVanishing = 1e-200;

// Rows of a block in straight code where several columns go at once; otherwise memory is scarce.
constexpr int kUnrolled = Lanes<double>::kCount > 1 ? 9 : 1;

// Unknowns that are worth a factor of their own; its rows have a fixed length, with room for the
// last lanes.
constexpr std::size_t kNarrow = 16;
constexpr std::size_t kNarrowRow = kNarrow + 1 + Lanes<double>::kCount;

// Sum of kTerms terms, in three chains where they are many: none waits for all the others.
template <typename V, int kTerms, typename Term>
[[gnu::always_inline]] inline V sum_of(Term term) {
  constexpr int kChains = kTerms >= 9 && kUnrolled > 1 ? 3 : 1;
  std::array<V, kChains> sums;
  for (int k = 0; k < kChains; ++k) sums[k] = term(k);
#pragma GCC unroll kUnrolled
  for (int k = kChains; k < kTerms; ++k) sums[k % kChains] += term(k);
  if constexpr (kChains == 1) {
    return sums[0];
  } else {
    return sums[0] + sums[1] + sums[2];
  }
}

// Rotates `block`, of `unknowns` + 1 columns, into the factor `r`: leaves zeros and, in the last
// column, the residuals. The factor is packed, or kNarrow with rows of kNarrowRow.
template <bool kPacked, int kRows>
void rotate(double* r, std::size_t unknowns, RowBlock<kRows>& block) {
  for (std::size_t j = 0; j < unknowns; ++j) {
    const std::size_t width = unknowns + 1 - j;
    std::array<double, kRows> v;
#pragma GCC unroll kUnrolled
    for (int k = 0; k < kRows; ++k) v[k] = block.rows[k][j];
    const auto squares = sum_of<double, kRows>([&](int k) { return v[k] * v[k]; });
    if (squares > kVanishing) {
      // The reflection that takes (R_jj, v) to (norm, 0). R_jj is never negative, so this form of
      // the first component cannot cancel; beta = 2 / (v_0^2 + squares).
      const double norm = std::sqrt(r[0] * r[0] + squares);
      const double v_0 = -squares / (r[0] + norm);
      const double beta = (r[0] + norm) / (norm * squares);
      r[0] = norm;
      // As many columns at a time as V has lanes.
      const auto reflect = [&]<typename V>(std::size_t c) {
        const auto above = load<V>(r + c);
        const V dot = beta * sum_of<V, kRows + 1>([&](int k) {
                        return k == 0 ? v_0 * above : v[k - 1] * load<V>(&block.rows[k - 1][j + c]);
                      });
        store(r + c, above - dot * v_0);
#pragma GCC unroll kUnrolled
        for (int k = 0; k < kRows; ++k) {
          double* below = &block.rows[k][j + c];
          store(below, load<V>(below) - dot * v[k]);
        }
      };
      constexpr std::size_t kLanes = Lanes<double>::kCount;
      std::size_t c = 1;
      for (; c + (kPacked ? kLanes : 1) <= width; c += kLanes) {
        reflect.template operator()<Pack<double>>(c);
      }
      for (; c < width; ++c) reflect.template operator()<double>(c);
    }
    r += kPacked ? width : kNarrowRow + 1;
  }
}

// Moves the entries of rows that involve only the unknowns `columns` to where they stand among all
// `unknowns`, zeros between them.
void spread(std::span<const std::uint8_t> columns, std::size_t unknowns, RowBlock<9>& block) {
  for (auto& row : block.rows) {
    row[unknowns] = row[columns.size()];
    std::size_t end = unknowns;
    for (std::size_t i = columns.size(); i-- > 0;) {
      const std::size_t column = columns[i];
      row[column] = row[i];
      std::fill(row.begin() + column + 1, row.begin() + end, 0.0);
      end = column;
    }
    std::fill(row.begin(), row.begin() + end, 0.0);
  }
}

// y -= factor x, of `count` numbers.
void subtract(double factor, const double* x, std::size_t count, double* y) {
  using V = Pack<double>;
  std::size_t c = 0;
  for (; c + Lanes<double>::kCount <= count; c += Lanes<double>::kCount) {
    store(y + c, load<V>(y + c) - factor * load<V>(x + c));
  }
  for (; c < count; ++c) y[c] -= factor * x[c];
}

double product(const double* x, const double* y, std::size_t count) {
  using V = Pack<double>;
  V sums{};
  std::size_t c = 0;
  for (; c + Lanes<double>::kCount <= count; c += Lanes<double>::kCount) {
    sums += load<V>(x + c) * load<V>(y + c);
  }
  auto sum = sum_of_lanes<double>(sums);
  for (; c < count; ++c) sum += x[c] * y[c];
  return sum;
}

}  // namespace

void SquareRootFactor::reset(std::size_t unknowns) {
  ARMSIG_CHECK(unknowns <= kMaxParameters);
  unknowns_ = unknowns;
  residual_squares_ = 0;
  all_tied_ = false;
  const std::size_t used = row(unknowns);
  for (std::size_t i = 0; i < used; ++i) entries_[i] = 0;
  for (std::size_t i = 0; i < unknowns; ++i) ties_[i].reset();
}

template <int kRows>
void SquareRootFactor::absorb(RowBlock<kRows>& block) {
  all_tied_ = true;
  rotate<true>(entries_.data(), unknowns_, block);
  for (const auto& left : block.rows) residual_squares_ += left[unknowns_] * left[unknowns_];
}

void SquareRootFactor::absorb(std::span<const std::uint8_t> columns, RowBlock<9>& block) {
  const std::size_t count = columns.size();
  Unknowns involved;
  for (const std::uint8_t column : columns) involved[column] = true;
  bool apart = !all_tied_ && count <= kNarrow;
  for (std::size_t i = 0; apart && i < count; ++i) apart = (ties_[columns[i]] & ~involved).none();
  if (!apart) {
    spread(columns, unknowns_, block);
    absorb(block);
    return;
  }

  // The rows of these unknowns as a factor of their own. Zeros beyond the right-hand side, so that
  // the last lanes hold numbers.
  constexpr Pack<double> kZeros{};
  std::array<double, kNarrow * kNarrowRow> narrow;
  for (std::size_t i = 0; i < count; ++i) {
    const double* from = entries_.data() + row(columns[i]) - columns[i];
    double* to = narrow.data() + i * kNarrowRow;
    for (std::size_t j = i; j < count; ++j) to[j] = from[columns[j]];
    to[count] = from[unknowns_];
    store(to + count + 1, kZeros);
  }
  for (auto& row : block.rows) store(&row[count + 1], kZeros);
  rotate<false>(narrow.data(), count, block);
  Unknowns later;
  for (std::size_t i = count; i-- > 0;) {
    double* to = entries_.data() + row(columns[i]) - columns[i];
    const double* from = narrow.data() + i * kNarrowRow;
    for (std::size_t j = i; j < count; ++j) to[columns[j]] = from[j];
    to[unknowns_] = from[count];
    ties_[columns[i]] |= later;
    later[columns[i]] = true;
  }
  for (const auto& left : block.rows) residual_squares_ += left[count] * left[count];
}

template void SquareRootFactor::absorb<1>(RowBlock<1>&);
template void SquareRootFactor::absorb<2>(RowBlock<2>&);
template void SquareRootFactor::absorb<3>(RowBlock<3>&);
template void SquareRootFactor::absorb<4>(RowBlock<4>&);
template void SquareRootFactor::absorb<9>(RowBlock<9>&);

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

void SquareRootFactor::solve_upper(std::span<double> z) const {
  for (std::size_t i = unknowns_; i-- > 0;) {
    const double* r = entries_.data() + row(i);
    z[i] = (z[i] - product(r + 1, z.data() + i + 1, unknowns_ - i - 1)) / r[0];
  }
}

void SquareRootFactor::solve_transposed(std::span<double> b, std::size_t first) const {
  for (std::size_t i = first; i < unknowns_; ++i) {
    const double* r = entries_.data() + row(i);
    const double y = b[i] / r[0];
    b[i] = y;
    if (y == 0) continue;
    subtract(y, r + 1, unknowns_ - i - 1, b.data() + i + 1);
  }
}

double SquareRootFactor::variance(std::span<double> b, std::size_t first) const {
  solve_transposed(b, first);
  return product(&b[first], &b[first], unknowns_ - first);
}

Matrix3 SquareRootFactor::covariance(RowBlock<3>& J) const {
  for (auto& row : J.rows) solve_transposed(row);
  Matrix3 covariance;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          product(J.rows[i].data(), J.rows[j].data(), unknowns_);
    }
  }
  return covariance;
}

}  // namespace armsig::refinement
