// SPDX-License-Identifier: MIT
// A joint that turns without end has no limits: both are infinite, so that whatever compares a
// reading with them lets it pass.
#pragma once

#include <cmath>
#include <limits>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig {

inline constexpr JointLimits kNoLimits{-std::numeric_limits<double>::infinity(),
                                       std::numeric_limits<double>::infinity()};

[[nodiscard]] inline bool is_endless(const JointLimits& limits) {
  return std::isinf(limits.lower) && std::isinf(limits.upper);
}

// Where readings that stand for all of a joint's are taken: inside its limits; of a joint without
// end, one turn around zero.
[[nodiscard]] inline JointLimits finite_range(const JointLimits& limits) {
  return is_endless(limits) ? JointLimits{-kPi, kPi} : limits;
}

// The middle of it.
[[nodiscard]] inline double middle_of(const JointLimits& limits) {
  const JointLimits range = finite_range(limits);
  return (range.lower + range.upper) / 2;
}

}  // namespace armsig
