// SPDX-License-Identifier: MIT
#include <algorithm>

#include "core/identification.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/selftest/checks.hpp"
#include "firmware/selftest/values.hpp"

namespace armsig::selftest {

void check_single_precision(Report& report) {
  double worst_m = 0;
  for (const KnownArm& known : kArms) {
    Arm arm;
    arm.joints = rows(known.rows, known.joint_count);
    // The signature as it is stored; a committed one is turned into the chain once.
    const JointVector q_s = readings(known.poses[0].q, known.joint_count);
    const auto chain = kinematics::chain_of<float>(signature_of(arm, q_s, Pose{}, {}));
    for (const KnownPose& pose : known.poses) {
      const JointVector q = readings(pose.q, known.joint_count);
      const PoseT<float> X = kinematics::link_pose(chain, q, known.joint_count);
      worst_m = std::max(worst_m, (X.p.cast<double>() - vector(pose.p_m)).norm());
    }
  }
  report.check("single_precision_um", 1e6 * worst_m, 5);
}

}  // namespace armsig::selftest
