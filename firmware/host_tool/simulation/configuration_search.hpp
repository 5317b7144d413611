// SPDX-License-Identifier: MIT
// A signature configuration that a person would choose: above the table, elbow up, stretched, with
// room for a good sweep of every joint.
#pragma once

#include "core/clearance/clearance.hpp"

namespace armsig::tool {

// The best found of some hundreds, always the same for the same arm, in steps of 15 degrees or a
// tenth of a stroke from the limits' middle (revolute joints: from zero, where the limits hold it).
// Empty: none is clear.
[[nodiscard]] JointVector chosen_configuration(const Arm& arm,
                                               const clearance::Surroundings& around);

}  // namespace armsig::tool
