// SPDX-License-Identifier: MIT
#include "core/numerics/quantiles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace armsig::numerics {

double chi_square_quantile(double freedom, double sigmas, double noise_freedom) {
  const double a = 2.0 / (9.0 * freedom);
  const double b = noise_freedom > 0 ? 2.0 / (9.0 * noise_freedom) : 0;
  // Normal is ((1 - b) x - (1 - a)) / sqrt(b x^2 + a), x the cube root: a quadratic equation.
  const double square = (1 - b) * (1 - b) - sigmas * sigmas * b;
  if (square <= 0) return std::numeric_limits<double>::infinity();
  const double half = (1 - a) * (1 - b);
  const double constant = (1 - a) * (1 - a) - sigmas * sigmas * a;
  const double root = std::sqrt(std::max(0.0, half * half - square * constant));
  const double x = (half + std::copysign(root, sigmas)) / square;
  return freedom * x * x * x;
}

}  // namespace armsig::numerics
