// SPDX-License-Identifier: MIT
#include "firmware/controller/held_out.hpp"

#include <algorithm>
#include <cmath>

#include "core/frames/link_frames.hpp"

namespace armsig::controller {
namespace {

using kinematics::SModelChain;

SModelChain<double> chain_of_model(const SignatureRecord* active, const Arm& drawing,
                                   const JointVector& q) {
  if (active != nullptr) return kinematics::chain_of<double>(active->signature);
  return kinematics::chain_of<double>(types_of(drawing.joints), q,
                                      frames::link_frames(drawing.joints, q).X_0L);
}

frames::AxisLines axes_at(const SModelChain<double>& chain, const JointVector& q) {
  FixedVector<Pose, kMaxFrames> X_WL;
  for (std::size_t k = 0; k <= chain.types.size(); ++k) {
    X_WL.push_back(kinematics::link_pose(chain, q, k));
  }
  return frames::axis_lines(X_WL, chain.types);
}

calibration::ServoReadings joints_of(const SignatureRecord* record, const Arm& drawing) {
  if (record == nullptr) return {};
  return {record->deflections, drawing, record->signature.configuration};
}

Vector3 target_in_last_frame(const SignatureRecord& record) {
  return record.signature.X_SL.back().inverse() * record.signature.targets[0].p_S;
}

double miss_m2(const Pose& X_SL, const Vector3& p_L, const Vector3& p_S) {
  return (X_SL * p_L - p_S).squaredNorm();
}

// Readings of this machine are finite, and within its limits.
JointVector turned(const calibration::ServoReadings& joints, const JointVector& q) {
  return joints.turned(q).value_or(q);
}

}  // namespace

HeldOutComparison::HeldOutComparison(const SignatureRecord& candidate,
                                     const SignatureRecord* active, const Arm& drawing)
    : candidate_{kinematics::chain_of<double>(candidate.signature), joints_of(&candidate, drawing),
                 target_in_last_frame(candidate)},
      active_{chain_of_model(active, drawing, candidate.signature.configuration),
              joints_of(active, drawing),
              {}},
      aligning_(frames::axis_lines(candidate.signature),
                axes_at(active_.chain, turned(active_.joints, candidate.signature.configuration))) {
  if (active == nullptr) return;
  p_L_stood_ = target_in_last_frame(*active);
  stood_m2_ = 0;
}

Pose HeldOutComparison::last_frame(const Predictor& model, const JointVector& q) {
  return kinematics::link_pose(model.chain, turned(model.joints, q), model.chain.types.size());
}

bool HeldOutComparison::step() {
  if (aligning_.step()) return true;
  X_laid_ = aligning_.result().X_AB;
  const JointVector& q = candidate_.chain.configuration;
  const Vector3 p_S = last_frame(candidate_, q) * candidate_.p_L;
  active_.p_L = (X_laid_ * last_frame(active_, q)).inverse() * p_S;
  return false;
}

void HeldOutComparison::judge(const JointVector& readings, const Vector3& p_S) {
  const Pose X_stood = last_frame(active_, readings);
  stood_m2_ += miss_m2(X_stood, p_L_stood_, p_S);
  laid_m2_ += miss_m2(X_laid_ * X_stood, active_.p_L, p_S);
  candidate_m2_ += miss_m2(last_frame(candidate_, readings), candidate_.p_L, p_S);
  ++poses_;
}

HeldOutReport HeldOutComparison::report() const {
  if (poses_ == 0) return {};
  const auto count = static_cast<double>(poses_);
  return {poses_, std::sqrt(candidate_m2_ / count),
          std::sqrt(std::min(stood_m2_, laid_m2_) / count)};
}

}  // namespace armsig::controller
