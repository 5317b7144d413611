// SPDX-License-Identifier: MIT
#include "core/kinematics/s_model_chain.hpp"

namespace armsig::kinematics {

Pose link_pose(const Signature& signature, const JointVector& q, std::size_t link) {
  return link_pose(chain_of<double>(signature), q, link);
}

Vector3 target_position(const Signature& signature, const JointVector& q, const Target& target) {
  const Vector3 p_L = signature.X_SL[target.link].inverse() * target.p_S;
  return link_pose(signature, q, target.link) * p_L;
}

}  // namespace armsig::kinematics
