// SPDX-License-Identifier: MIT
// Manufacturing errors: one individual of a drawing.
#pragma once

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "hal/simulated/random.hpp"

namespace armsig::simulated {

// 1 sigma of each Denavit-Hartenberg parameter about its nominal one; the defaults are those of
// docs/model.md, section 12.
struct Tolerances {
  double alpha_rad = radians(0.1);
  double theta_rad = radians(0.2);
  double a_m = 0.5e-3;
  double d_m = 0.5e-3;
};

// An arm whose parameters differ from the nominal ones by independent normal errors, the same way
// for revolute and prismatic joints. Limits and couplings stay. One arm consumes four normals a
// joint.
[[nodiscard]] Arm drawn_arm(const Arm& nominal, const Tolerances& tolerances, Random& random);

}  // namespace armsig::simulated
