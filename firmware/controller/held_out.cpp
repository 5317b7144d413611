// SPDX-License-Identifier: MIT
#include "firmware/controller/held_out.hpp"

#include <cmath>

#include "core/frames/link_frames.hpp"

namespace armsig::controller {
namespace {

using kinematics::SModelChain;

SModelChain<double> chain_of_model(const Signature* active, const Arm& drawing,
                                   const JointVector& q) {
  if (active != nullptr) return kinematics::chain_of<double>(*active);
  FixedVector<JointType, kMaxJoints> types;
  for (const DhJoint& row : drawing.joints) types.push_back(row.type);
  return kinematics::chain_of<double>(types, q, frames::link_frames(drawing.joints, q).X_0L);
}

Pose last_frame(const SModelChain<double>& chain, const JointVector& q) {
  return kinematics::link_pose(chain, q, chain.types.size());
}

frames::AxisLines axes_at(const SModelChain<double>& chain, const JointVector& q) {
  FixedVector<Pose, kMaxFrames> X_WL;
  for (std::size_t k = 0; k <= chain.types.size(); ++k) {
    X_WL.push_back(kinematics::link_pose(chain, q, k));
  }
  return frames::axis_lines(X_WL, chain.types);
}

}  // namespace

HeldOutComparison::HeldOutComparison(const Signature& candidate, const Signature* active,
                                     const Arm& drawing)
    : candidate_{kinematics::chain_of<double>(candidate),
                 candidate.X_SL.back().inverse() * candidate.targets[0].p_S},
      active_{chain_of_model(active, drawing, candidate.configuration), {}},
      aligning_(frames::axis_lines(candidate), axes_at(active_.chain, candidate.configuration)) {}

bool HeldOutComparison::step() {
  if (aligning_.step()) return true;
  active_.chain.X_S0 = aligning_.result().X_AB * active_.chain.X_S0;
  const JointVector& q = candidate_.chain.configuration;
  active_.p_L =
      last_frame(active_.chain, q).inverse() * (last_frame(candidate_.chain, q) * candidate_.p_L);
  return false;
}

void HeldOutComparison::judge(const JointVector& readings, const Vector3& p_S) {
  const auto miss_m2 = [&](const Predictor& model) {
    return (last_frame(model.chain, readings) * model.p_L - p_S).squaredNorm();
  };
  candidate_m2_ += miss_m2(candidate_);
  active_m2_ += miss_m2(active_);
  ++poses_;
}

HeldOutReport HeldOutComparison::report() const {
  if (poses_ == 0) return {};
  const auto count = static_cast<double>(poses_);
  return {poses_, std::sqrt(candidate_m2_ / count), std::sqrt(active_m2_ / count)};
}

}  // namespace armsig::controller
