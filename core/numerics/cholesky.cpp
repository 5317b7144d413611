// SPDX-License-Identifier: MIT
#include "core/numerics/cholesky.hpp"

#include <cmath>

namespace armsig::numerics {

bool factor_positive(Square& a, Eigen::Index n) {
  for (Eigen::Index j = 0; j < n; ++j) {
    double pivot = a(j, j);
    for (Eigen::Index k = 0; k < j; ++k) pivot -= a(j, k) * a(j, k);
    if (!(pivot > 0)) return false;
    a(j, j) = std::sqrt(pivot);
    for (Eigen::Index i = j + 1; i < n; ++i) {
      double sum = a(i, j);
      for (Eigen::Index k = 0; k < j; ++k) sum -= a(i, k) * a(j, k);
      a(i, j) = sum / a(j, j);
    }
  }
  return true;
}

void solve_lower(const Square& lower, Column& b, Eigen::Index n) {
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < i; ++k) b[i] -= lower(i, k) * b[k];
    b[i] /= lower(i, i);
  }
}

void solve_lower_transposed(const Square& lower, Column& b, Eigen::Index n) {
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    for (Eigen::Index k = i + 1; k < n; ++k) b[i] -= lower(k, i) * b[k];
    b[i] /= lower(i, i);
  }
}

bool solve_positive(Square& a, Column& b, Eigen::Index n) {
  if (!factor_positive(a, n)) return false;
  solve_lower(a, b, n);
  solve_lower_transposed(a, b, n);
  return true;
}

}  // namespace armsig::numerics
