// SPDX-License-Identifier: MIT
// The model that the arm is servoed with: the drawing, or a committed signature.
#pragma once

#include "core/calibration/servo_inverse.hpp"
#include "core/signature.hpp"
#include "firmware/controller/configuration.hpp"
#include "firmware/controller/signature_figures.hpp"

namespace armsig::controller {

// Tool poses are of frame n moved to the tool point, in the frame R that the model is told in.
struct Model {
  kinematics::Chain chain;            // pseudo-DH (21), with the limits of what the joints may turn
  calibration::ServoReadings joints;  // how far they do for their readings
  Pose X_R0;                          // a signature: R is the sensor frame; the drawing: its base
  Vector3 p_nT = Vector3::Zero();     // the tool point in frame n
  bool identified = false;
  SignatureFigures figures;  // of the signature, where the model is of a record
};

// The drawing, its tool at the origin of its last frame.
[[nodiscard]] Model model_of(const Arm& drawing);
void make_model(const Arm& drawing, Model& model);

// A signature, its tool at its target on the hand. Made in place, as it is large. Precondition:
// calibration::check() accepts the deflections.
void make_model(const SignatureRecord& record, const Arm& drawing, Model& model);
[[nodiscard]] Model model_of(const Signature& signature, const Arm& drawing);

// Tool pose in R at readings q. Errors: kNotFinite.
[[nodiscard]] Result<Pose> tool_pose(const Model& model, const JointVector& q);

// Pose of frame n in frame 0 for a tool pose in R, as the inverse wants it.
[[nodiscard]] inline Pose flange_pose(const Model& model, const Pose& X_RT) {
  const Pose X_0T = model.X_R0.inverse() * X_RT;
  return {X_0T.R, X_0T.p - X_0T.R * model.p_nT};
}

// Whether the model has fewer joints than a pose has dimensions: the tool's position is met, and
// its orientation missed by what InverseSolution says.
[[nodiscard]] inline bool may_miss_orientation(const Model& model) {
  return model.chain.joint_count < 6;
}

// The readings, near `seed`, at which the tool is at X_RT, as kinematics::inverse() finds them with
// `options`, of which the point is set here; `lately`: what the inverse before found, where this
// one follows it. Errors: those of calibration::inverse().
[[nodiscard]] Result<kinematics::InverseSolution> joints_for(const Model& model, const Pose& X_RT,
                                                             const JointVector& seed,
                                                             kinematics::InverseOptions options,
                                                             calibration::LatelyTurned& lately);

}  // namespace armsig::controller
