// SPDX-License-Identifier: MIT
// What a sum of squares of noise alone may reach: the one place of the limits that gates judge by.
#pragma once

#include <array>

namespace armsig::numerics {

// Shares of good data that a limit refuses all the same (false alarms). One reading in 10,000 costs
// nothing, and biases the variance of those that stay by little.
inline constexpr double kReadingRefused = 1e-4;
// The same in 1,000: what a person is told after a whole check.
inline constexpr double kCheckRefused = 1e-3;
// Beyond 5 sigma of a normal variable on one side: what interrupts an arm at work.
inline constexpr double kFiveSigma = 2.8665157e-7;

// Quantiles of chi-square with 1, 2, ... degrees of freedom at a false alarm of kReadingRefused.
inline constexpr std::array<double, 13> kChiSquare9999 = {
    15.1367052, 18.4206807, 21.1075135, 23.5127424, 25.7448320, 27.8563412, 29.8775039,
    31.8276280, 33.7199484, 35.5640139, 37.3669864, 39.1344039, 40.8706550};

// Medians of chi-square with 1 and 3 degrees of freedom.
inline constexpr double kChiSquareMedian1 = 0.4549364;
inline constexpr double kChiSquareMedian3 = 2.3659739;

// The value that a chi-square variable of `freedom` degrees exceeds with the probability
// `false_alarm`. Where its unit was itself found with `noise_freedom` > 0 degrees, the value is
// `freedom` times that of Fisher's law. 0 where `freedom` is not above 0: nothing is to be judged.
// Precondition: 0 < false_alarm <= 0.1. Relative error below 1e-7 from 1 to a million degrees of
// either kind. Time grows with the square root of the degrees: about a microsecond for a hundred.
// Source: continued fractions of the incomplete gamma and beta functions (Abramowitz and Stegun,
// 6.5.31 and 26.5.8), inverted by Newton's method.
[[nodiscard]] double chi_square_quantile(double freedom, double false_alarm,
                                         double noise_freedom = 0);

}  // namespace armsig::numerics
