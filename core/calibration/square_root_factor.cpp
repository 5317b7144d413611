// SPDX-License-Identifier: MIT
#include "core/calibration/square_root_factor.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "core/base/lanes.hpp"

namespace armsig::calibration {

namespace {

// Below this sum of squares a column counts as zero: its cube would be lost in underflow, and no
// measurement in SI units comes near it.
constexpr double kVanishing = 1e-200;

// Rows of a block in straight code where several columns go at once; otherwise memory is scarce.
constexpr int kUnrolled = Lanes<double>::kCount > 1 ? 3 : 1;

// Sum of kTerms terms.
template <int kTerms, typename Term>
[[gnu::always_inline]] inline auto sum_of(Term term) {
  auto sum = term(0);
#pragma GCC unroll kUnrolled
  for (int k = 1; k < kTerms; ++k) sum += term(k);
  return sum;
}

// Rotates `block`, of `unknowns` + 1 columns, into the packed factor `r`: leaves zeros and, in the
// last column, the residuals.
template <int kRows>
void rotate(double* r, std::size_t unknowns, RowBlock<kRows>& block) {
  for (std::size_t j = 0; j < unknowns; ++j) {
    const std::size_t width = unknowns + 1 - j;
    std::array<double, kRows> v;
#pragma GCC unroll kUnrolled
    for (int k = 0; k < kRows; ++k) v[k] = block.rows[k][j];
    const double squares = sum_of<kRows>([&](int k) { return v[k] * v[k]; });
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
        const V dot = beta * sum_of<kRows + 1>([&](int k) -> V {
                        return k == 0 ? v_0 * above : v[k - 1] * load<V>(&block.rows[k - 1][j + c]);
                      });
        store(r + c, above - dot * v_0);
#pragma GCC unroll kUnrolled
        for (int k = 0; k < kRows; ++k) {
          double* below = &block.rows[k][j + c];
          store(below, load<V>(below) - dot * v[k]);
        }
      };
      constexpr std::size_t kAtOnce = Lanes<double>::kCount;
      std::size_t c = 1;
      for (; c + kAtOnce <= width; c += kAtOnce) reflect.template operator()<Pack<double>>(c);
      for (; c < width; ++c) reflect.template operator()<double>(c);
    }
    r += width;
  }
}

// `count` numbers as a vector.
Eigen::Map<const Eigen::VectorXd> vector_of(const double* x, std::size_t count) {
  return {x, static_cast<Eigen::Index>(count)};
}
Eigen::Map<Eigen::VectorXd> vector_of(double* x, std::size_t count) {
  return {x, static_cast<Eigen::Index>(count)};
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

template void SquareRootFactor::absorb<1>(RowBlock<1>&);
template void SquareRootFactor::absorb<3>(RowBlock<3>&);

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
    const std::size_t later = unknowns_ - i - 1;
    z[i] = (z[i] - vector_of(r + 1, later).dot(vector_of(z.data() + i + 1, later))) / r[0];
  }
}

void SquareRootFactor::solve_transposed(std::span<double> b, std::size_t first) const {
  for (std::size_t i = first; i < unknowns_; ++i) {
    const double* r = entries_.data() + row(i);
    const double y = b[i] / r[0];
    b[i] = y;
    if (y == 0) continue;
    const std::size_t later = unknowns_ - i - 1;
    vector_of(b.data() + i + 1, later) -= y * vector_of(r + 1, later);
  }
}

double SquareRootFactor::variance(std::span<double> b, std::size_t first) const {
  solve_transposed(b, first);
  return vector_of(&b[first], unknowns_ - first).squaredNorm();
}

Matrix3 SquareRootFactor::covariance(RowBlock<3>& J) const {
  for (auto& row : J.rows) solve_transposed(row);
  Matrix3 covariance;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          vector_of(J.rows[i].data(), unknowns_).dot(vector_of(J.rows[j].data(), unknowns_));
    }
  }
  return covariance;
}

}  // namespace armsig::calibration
