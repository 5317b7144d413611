// SPDX-License-Identifier: MIT
// The threshold of the drift sum, from the rate of false alarms that is stood for; and what that
// threshold then finds. Both are computed by following many arms through their checks, because no
// closed form holds once the reference itself was measured and checks are correlated: a baseline of
// 20 checks is wrong by a quarter of a sigma, always in the same direction. The random numbers are
// the same in every call, so are the results.
#pragma once

#include "core/base/error.hpp"

namespace armsig::drift {

// How checks of an arm that does not change scatter about the reference.
struct Scatter {
  int baseline = 0;        // checks whose mean is the reference; 0: known exactly. At most 1,000
  double correlation = 0;  // of a component with that of the check before; 0 to below 1
  double sigma_ratio = 1;  // actual sigma over the one told; 0.1 to 10
};

struct FalseAlarms {
  double checks_per_month = 365.25 / 12;
  double per_month = 0.001;  // of one arm
  double months = 12;        // over which they are counted, from the baseline on
};

// The least threshold h, in steps of 0.01, with which at most `per_month` x `months` of the arms
// are named within `months`. One sigma of the result is below 0.1. About 0.5 s.
// Errors: kOutOfRange (an argument outside its range; below 1 or above 5,000 checks; a share of
// arms outside 0.001 to 0.5); kNotConverged (no threshold below 80: the reference value k is too
// small for this scatter).
[[nodiscard]] Result<double> threshold(double reference, const Scatter& scatter,
                                       const FalseAlarms& allowed);

struct Detection {
  double within = 0;       // share of arms named within the checks asked for
  double mean_checks = 0;  // of those, from the change to the check that named them
};

// What becomes of an arm that moves by `shift` (in sigma_c as told) once its baseline is there:
// followed for `checks` checks, 1 to 1,000. Errors: kOutOfRange.
[[nodiscard]] Result<Detection> detection(double reference, double threshold, double shift,
                                          int checks, const Scatter& scatter);

}  // namespace armsig::drift
