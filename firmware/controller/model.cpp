// SPDX-License-Identifier: MIT
#include "firmware/controller/model.hpp"

#include "core/kinematics/forward.hpp"

namespace armsig::controller {
namespace {

void make_model(const Signature& signature, const calibration::PackedDeflections& deflections,
                const Arm& drawing, Model& model) {
  model.joints.set(deflections, drawing, signature.configuration);
  model.chain = kinematics::make_chain(
      signature.pseudo_dh, model.joints.exact() ? drawing.limits : model.joints.turned_limits());
  model.p_nT = Vector3::Zero();
  model.X_R0 = signature.X_SL[0];
  model.identified = true;
  for (const Target& target : signature.targets) {
    if (target.link != signature.joint_count()) continue;
    if (const auto X_0n = kinematics::forward(model.chain, signature.configuration)) {
      model.p_nT = (model.X_R0 * *X_0n).inverse() * target.p_S;
    }
    break;
  }
}

}  // namespace

void make_model(const Arm& drawing, Model& model) {
  model.chain = kinematics::make_chain(drawing.joints, drawing.limits);
  model.joints.set_exact();
  model.X_R0 = {};
  model.p_nT = Vector3::Zero();
  model.identified = false;
  model.figures = {};
}

Model model_of(const Arm& drawing) {
  Model model;
  make_model(drawing, model);
  return model;
}

void make_model(const SignatureRecord& record, const Arm& drawing, Model& model) {
  make_model(record.signature, record.deflections, drawing, model);
  model.figures = SignatureFigures(record);
}

Model model_of(const Signature& signature, const Arm& drawing) {
  Model model;
  make_model(signature, {}, drawing, model);
  return model;
}

Result<Pose> tool_pose(const Model& model, const JointVector& q) {
  ARMSIG_TRY(X_0n, calibration::forward(model.chain, model.joints, q));
  const Pose X_Rn = model.X_R0 * X_0n;
  return Pose{X_Rn.R, X_Rn * model.p_nT};
}

Result<kinematics::InverseSolution> joints_for(const Model& model, const Pose& X_RT,
                                               const JointVector& seed,
                                               kinematics::InverseOptions options,
                                               calibration::LatelyTurned& lately) {
  // Where the whole pose is met, the point does not matter.
  if (may_miss_orientation(model)) options.p_nP = model.p_nT;
  return calibration::inverse(model.chain, model.joints, flange_pose(model, X_RT), seed, options,
                              lately);
}

}  // namespace armsig::controller
