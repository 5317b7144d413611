// SPDX-License-Identifier: MIT
// What couplings do to an arm as a whole.
#pragma once

#include <algorithm>
#include <array>

#include "core/base/arm.hpp"

namespace armsig {

// Whether `joint` hangs, through others, on itself: effective_readings() could not be undone.
// Precondition: every joint named is below kMaxJoints.
[[nodiscard]] inline bool leads_back(const JointCouplings& couplings, std::size_t joint) {
  std::array<bool, kMaxJoints> reached{};
  // Each pass reaches at least one joint further.
  for (std::size_t pass = 0; pass < kMaxJoints; ++pass) {
    for (const JointCoupling& coupling : couplings) {
      if (coupling.joint == joint || reached[coupling.joint]) reached[coupling.from] = true;
    }
  }
  return reached[joint];
}

// The limits of effective readings: those of a coupled joint as wide as its effective reading gets
// inside the limits of both. Precondition: one entry a joint.
[[nodiscard]] inline FixedVector<JointLimits, kMaxJoints> effective_limits(const Arm& arm) {
  FixedVector<JointLimits, kMaxJoints> effective = arm.limits;
  for (const JointCoupling& coupling : arm.couplings) {
    if (coupling.ratio == 0) continue;  // times a limit that is infinite it would be no number
    const JointLimits& from = arm.limits[coupling.from];
    const auto [least, most] =
        std::minmax({coupling.ratio * from.lower, coupling.ratio * from.upper});
    effective[coupling.joint].lower += least;
    effective[coupling.joint].upper += most;
  }
  return effective;
}

}  // namespace armsig
