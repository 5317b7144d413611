// SPDX-License-Identifier: MIT
// Sweeps over which the whole arm stays clear of its surroundings, by the nominal model.
#pragma once

#include "core/clearance/clearance.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/host_tool/simulation/sweep_plan.hpp"

namespace armsig::tool {

// Less than this of a turn says too little of an axis.
inline constexpr double kLeastArc_rad = radians(30);
// And less than this of a way of a slide.
inline constexpr double kLeastStroke_m = 0.02;

// Refuses a configuration in which the arm is not clear, by the link, its place and what it is near
// to.
[[nodiscard]] Read<void> check_configuration(const Arm& arm, const clearance::Surroundings& around,
                                             const JointVector& configuration);

// A sweep of each joint about the configuration over what limits and surroundings leave of it: a
// revolute joint through its arc of `arcs_rad` (a turn at most), moved where that leaves too little
// on one side, cut where both do; a prismatic one as far as it goes. Refuses a configuration that
// is not clear, and a joint that can sweep less than kLeastArc_rad or kLeastStroke_m, by its number
// and what stops it. Preconditions: points >= 2, a reading and an arc a joint.
[[nodiscard]] Read<SweepPlan> clear_sweeps(const Arm& arm, const clearance::Surroundings& around,
                                           const JointVector& configuration,
                                           const JointVector& arcs_rad, std::size_t points);

}  // namespace armsig::tool
