// SPDX-License-Identifier: MIT
// Sweeps that stay inside a box, by the drawing.
#pragma once

#include <limits>

#include "firmware/formats/problem.hpp"
#include "firmware/host_tool/simulation/sweep_plan.hpp"

namespace armsig::tool {

// Where the target may be, in the base B of the drawing.
struct ReachBox {
  Vector3 lower_B = Vector3::Constant(-std::numeric_limits<double>::infinity());
  Vector3 upper_B = Vector3::Constant(std::numeric_limits<double>::infinity());
  Vector3 p_FT = Vector3::Zero();  // the target in the last frame of the drawing

  [[nodiscard]] bool holds(const Arm& arm, const JointVector& readings) const;
};

// Less than this of a turn says too little of an axis.
inline constexpr double kLeastArc_rad = radians(30);

// plan_sweeps(), each sweep cut to the readings about the configuration over which the target stays
// in the box, and spread over them anew. Refuses a configuration outside of the box, and a joint
// that can sweep less than kLeastArc_rad there, by its number.
[[nodiscard]] Read<SweepPlan> sweeps_inside(const Arm& arm, const JointVector& configuration,
                                            double arc_rad, std::size_t points,
                                            const ReachBox& box);

}  // namespace armsig::tool
