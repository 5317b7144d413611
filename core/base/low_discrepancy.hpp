// SPDX-License-Identifier: MIT
// Even coverage of the joint space without a random generator: the Halton sequence.
#pragma once

#include <algorithm>
#include <array>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig {

// The n-th number, in [0, 1), of the van der Corput sequence of joint `dimension`, each joint of an
// own prime: Halton's points.
[[nodiscard]] inline double halton(std::size_t dimension, int n) {
  constexpr std::array<int, kMaxJoints> kPrimes{2, 3, 5, 7, 11, 13, 17, 19};
  const int base = kPrimes[dimension];
  double value = 0;
  double digit_weight = 1;
  for (; n > 0; n /= base) {
    digit_weight /= base;
    value += digit_weight * (n % base);
  }
  return value;
}

// The n-th joint configuration, n >= 1, evenly spread within the limits; a revolute joint that can
// turn more than once stays within one turn, as near to zero as its limits let it.
[[nodiscard]] inline JointVector evenly_spread_configuration(
    const JointTypes& types, const FixedVector<JointLimits, kMaxJoints>& limits, int n) {
  JointVector q;
  for (std::size_t i = 0; i < types.size(); ++i) {
    auto [lower, upper] = limits[i];
    if (types[i] == JointType::kRevolute && upper - lower > 2 * kPi) {
      const double middle = std::clamp(0.0, lower + kPi, upper - kPi);
      lower = middle - kPi;
      upper = middle + kPi;
    }
    q.push_back(lower + halton(i, n) * (upper - lower));
  }
  return q;
}

// Configuration n >= 1 of those that stand for the work volume: the first elements of the larger
// primes run along a diagonal, these do not.
[[nodiscard]] inline JointVector work_configuration(
    const JointTypes& types, const FixedVector<JointLimits, kMaxJoints>& limits, int n) {
  constexpr int kSkipped = 19;
  return evenly_spread_configuration(types, limits, n + kSkipped);
}

}  // namespace armsig
