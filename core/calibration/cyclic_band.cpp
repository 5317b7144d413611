// SPDX-License-Identifier: MIT
#include "core/calibration/cyclic_band.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::calibration {

void CyclicFactor::factorise(const CyclicBand& measured, double variance,
                             const std::array<double, kSplines>& prior, double prior_variance) {
  const auto entry = [&](std::size_t i, std::size_t k) {
    return static_cast<double>(measured[i][k]) / variance + prior[k] / prior_variance;
  };
  for (std::size_t i = 0; i < kInner; ++i) {
    const std::size_t first = i < kBorder ? 0 : i - kBorder;
    for (std::size_t j = first; j <= i; ++j) {
      double sum = entry(j, i - j);
      for (std::size_t k = first; k < j; ++k) {
        if (j - k <= kBorder) sum -= inner_[i][k + kBorder - i] * inner_[j][k + kBorder - j];
      }
      inner_[i][j + kBorder - i] = i == j ? std::sqrt(sum) : sum / inner_[j][kBorder];
    }
  }
  for (std::size_t b = 0; b < kBorder; ++b) {
    const std::size_t i = kInner + b;
    std::array<double, kKnots>& row = border_[b];
    row.fill(0);
    for (std::size_t j = i - kBorder; j <= i; ++j) row[j] = entry(j, i - j);
    for (std::size_t k = 1; k < kSplines; ++k) {
      if (i + k >= kKnots) row[i + k - kKnots] += entry(i, k);
    }
    for (std::size_t j = 0; j < kInner; ++j) {
      for (std::size_t k = j < kBorder ? 0 : j - kBorder; k < j; ++k) {
        row[j] -= row[k] * inner_[j][k + kBorder - j];
      }
      row[j] /= inner_[j][kBorder];
    }
    for (std::size_t c = 0; c <= b; ++c) {
      const std::size_t j = kInner + c;
      for (std::size_t k = 0; k < j; ++k) row[j] -= row[k] * border_[c][k];
      row[j] = c == b ? std::sqrt(row[j]) : row[j] / border_[c][j];
    }
  }
}

void CyclicFactor::solve(MapCoefficients& b) const {
  for (std::size_t i = 0; i < kInner; ++i) {
    for (std::size_t k = i < kBorder ? 0 : i - kBorder; k < i; ++k) {
      b[i] -= inner_[i][k + kBorder - i] * b[k];
    }
    b[i] /= inner_[i][kBorder];
  }
  for (std::size_t c = 0; c < kBorder; ++c) {
    const std::size_t i = kInner + c;
    for (std::size_t k = 0; k < i; ++k) b[i] -= border_[c][k] * b[k];
    b[i] /= border_[c][i];
  }
  for (std::size_t c = kBorder; c-- > 0;) {
    const std::size_t i = kInner + c;
    b[i] /= border_[c][i];
    for (std::size_t k = 0; k < i; ++k) b[k] -= border_[c][k] * b[i];
  }
  for (std::size_t i = kInner; i-- > 0;) {
    b[i] /= inner_[i][kBorder];
    for (std::size_t k = i < kBorder ? 0 : i - kBorder; k < i; ++k) {
      b[k] -= inner_[i][k + kBorder - i] * b[i];
    }
  }
}

void CyclicFactor::inverse_rows(std::size_t first, std::size_t last, CyclicBand& band) const {
  MapCoefficients column;
  for (std::size_t i = first; i < last; ++i) {
    column.fill(0);
    column[i] = 1;
    solve(column);
    for (std::size_t k = 0; k < kSplines; ++k) {
      band[i][k] = static_cast<float>(column[(i + k) % kKnots]);
    }
  }
}

}  // namespace armsig::calibration
