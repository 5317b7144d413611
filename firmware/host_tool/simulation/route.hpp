// SPDX-License-Identifier: MIT
// The order in which an arm goes through poses to measure, by ways that are clear.
#pragma once

#include <span>
#include <vector>

#include "core/clearance/clearance.hpp"

namespace armsig::tool {

struct Stop {
  JointVector readings;
  bool measured = true;  // false: only gone through
};

// `home`, then `poses` in their order; `home` again between two whose straight way in the readings
// is not clear. Precondition: the straight way from `home` to each pose is clear.
[[nodiscard]] std::vector<Stop> route_by_home(const Arm& arm, const clearance::Surroundings& around,
                                              const JointVector& home,
                                              std::span<const JointVector> poses);

}  // namespace armsig::tool
