// SPDX-License-Identifier: MIT
// Expanded uncertainty of a position: the length that an error in three directions stays below with
// a stated probability. Twice the standard uncertainty is 95 % of one direction, not of a length.
#pragma once

#include <span>
#include <vector>

#include "core/base/pose.hpp"

namespace armsig::tool {

inline constexpr double kCoverageProbability = 0.95;

// Length of a normal error vector that has unit variance in each direction; of Student's
// multivariate law where that unit was found with `freedom` > 0 degrees.
class UnitLength {
 public:
  explicit UnitLength(double freedom);
  [[nodiscard]] double probability_below(double length) const;

 private:
  std::vector<double> probabilities_;  // at equal steps
};

// Probability that an error with these variances along its principal axes is no longer than
// `length`.
[[nodiscard]] double probability_below(const UnitLength& unit, const Vector3& variances,
                                       double length);

// The length that errors stay below with `probability`, over all `variances` alike.
[[nodiscard]] double coverage_length(const UnitLength& unit, std::span<const Vector3> variances,
                                     double probability);

}  // namespace armsig::tool
