// SPDX-License-Identifier: MIT
#include "core/calibration/cyclic_band.hpp"

#include <cmath>

#include <Eigen/LU>

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
  }
  // The rows of the border wait for each other's quotients no more than for their own.
  for (std::size_t j = 0; j < kInner; ++j) {
    for (std::array<double, kKnots>& row : border_) {
      for (std::size_t k = j < kBorder ? 0 : j - kBorder; k < j; ++k) {
        row[j] -= row[k] * inner_[j][k + kBorder - j];
      }
      row[j] /= inner_[j][kBorder];
    }
  }
  for (std::size_t b = 0; b < kBorder; ++b) {
    std::array<double, kKnots>& row = border_[b];
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

Matrix3 CyclicFactor::inverse_of_border() const {
  Matrix3 L_border;
  for (std::size_t b = 0; b < kBorder; ++b) {
    for (std::size_t c = 0; c < kBorder; ++c) {
      const double entry = c > b ? 0 : border_[b][kInner + c];
      L_border(static_cast<Eigen::Index>(b), static_cast<Eigen::Index>(c)) = entry;
    }
  }
  const Matrix3 L_inverse = L_border.inverse();
  return L_inverse.transpose() * L_inverse;
}

void CyclicFactor::invert(CyclicBand& band) const {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  // Of the inverse, between the three rows below the present one and the border's three.
  Matrix6 below = Matrix6::Zero();
  below.bottomRightCorner<3, 3>() = inverse_of_border();
  const auto take = [&band](std::size_t i, std::size_t j, double entry) {
    band[i][(j + kKnots - i) % kKnots] = static_cast<float>(entry);
  };
  for (Eigen::Index b = 0; b < 3; ++b) {
    for (Eigen::Index c = b; c < 3; ++c) {
      take(kInner + static_cast<std::size_t>(b), kInner + static_cast<std::size_t>(c),
           below(3 + b, 3 + c));
    }
  }
  for (std::size_t i = kInner; i-- > 0;) {
    Vector6 l = Vector6::Zero();  // what of column i of L is below its diagonal
    for (std::size_t k = 0; k < kBorder; ++k) {
      const auto near = static_cast<Eigen::Index>(k);
      if (i + 1 + k < kInner) l[near] = inner_[i + 1 + k][kBorder - 1 - k];
      l[near + 3] = border_[k][i];
    }
    const double diagonal = inner_[i][kBorder];
    const Vector6 row = below * l / -diagonal;
    const double own = (1 / diagonal - l.dot(row)) / diagonal;
    take(i, i, own);
    for (std::size_t k = 0; k < kBorder; ++k) {
      const auto near = static_cast<Eigen::Index>(k);
      if (i + 1 + k < kInner) take(i, i + 1 + k, row[near]);
      const std::size_t j = kInner + k;  // the border lies after the last row and before the first
      if (j - i < kSplines) take(i, j, row[near + 3]);
      if (i + kKnots - j < kSplines) take(j, i, row[near + 3]);
    }
    below.block<2, 2>(1, 1) = below.topLeftCorner<2, 2>().eval();
    below.block<2, 3>(1, 3) = below.topRightCorner<2, 3>().eval();
    below.block<1, 2>(0, 1) = row.head<2>().transpose();
    below.block<1, 3>(0, 3) = row.tail<3>().transpose();
    below(0, 0) = own;
    below.triangularView<Eigen::StrictlyLower>() = below.transpose();
  }
}

}  // namespace armsig::calibration
