// SPDX-License-Identifier: MIT
// What a sum of squares of noise alone may reach: the one place of the limits that gates judge by.
#pragma once

#include <array>

namespace armsig::numerics {

// 99.99 % quantile of the normal distribution: of 10,000 good values one lies above.
inline constexpr double kNormal9999 = 3.719;

// 99.99 % quantiles of chi-square with 1, 2, ... degrees of freedom.
inline constexpr std::array<double, 13> kChiSquare9999 = {15.137, 18.421, 21.108, 23.513, 25.745,
                                                          27.856, 29.878, 31.828, 33.720, 35.564,
                                                          37.367, 39.134, 40.871};

// Medians of chi-square with 1 and 3 degrees of freedom.
inline constexpr double kChiSquareMedian1 = 0.4549364;
inline constexpr double kChiSquareMedian3 = 2.3659739;

// The value that a chi-square variable of `freedom` degrees stays below but for `sigmas` of a
// normal variable (Wilson and Hilferty, 1931; within 2 % from 3 degrees on). With a unit of its own
// found with `noise_freedom` > 0 degrees, it is so many times a variable of Fisher's law (Paulson,
// 1942); infinite where those are too few to tell.
[[nodiscard]] double chi_square_quantile(double freedom, double sigmas, double noise_freedom = 0);

}  // namespace armsig::numerics
