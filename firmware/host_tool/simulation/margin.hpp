// SPDX-License-Identifier: MIT
// Joint limits with a margin inside them: a controller stops an arm that is sent to the limit
// itself.
#pragma once

#include <string>

#include "core/base/arm.hpp"
#include "firmware/formats/measurements.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

struct Margin {
  double angle_rad = 0.0;
  double length_m = 0.0;
};

// Refuses a joint whose limits leave no more than half of themselves.
[[nodiscard]] Read<FixedVector<JointLimits, kMaxJoints>> limits_with_margin(
    const FixedVector<JointLimits, kMaxJoints>& limits, const JointTypes& types,
    const Margin& margin);

}  // namespace armsig::tool
