// SPDX-License-Identifier: MIT
#include "hal/simulated/tolerances.hpp"

namespace armsig::simulated {

Arm drawn_arm(const Arm& nominal, const Tolerances& tolerances, Random& random) {
  Arm arm = nominal;
  for (DhJoint& joint : arm.joints) {
    joint.theta_rad += tolerances.theta_rad * random.normal();
    joint.d_m += tolerances.d_m * random.normal();
    joint.a_m += tolerances.a_m * random.normal();
    joint.alpha_rad += tolerances.alpha_rad * random.normal();
  }
  return arm;
}

}  // namespace armsig::simulated
