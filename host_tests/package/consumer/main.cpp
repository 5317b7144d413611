// SPDX-License-Identifier: MIT
// Uses the installed core: half a metre of arm, turned by a quarter.
#include <cstdio>

#include "core/identification.hpp"
#include "core/kinematics/s_model_chain.hpp"

int main() {
  armsig::Arm arm;
  arm.joints.push_back({armsig::JointType::kRevolute, 0, 0, 0.5, 0});
  arm.limits.push_back({-armsig::kPi, armsig::kPi});
  armsig::JointVector q;
  q.push_back(0);
  const armsig::Signature signature = armsig::signature_of(arm, q, armsig::Pose{}, {});
  q[0] = armsig::kPi / 2;
  const armsig::Vector3 p = armsig::kinematics::link_pose(signature, q, 1).p;
  std::printf("%.3f %.3f %.3f\n", p.x(), p.y(), p.z());
}
