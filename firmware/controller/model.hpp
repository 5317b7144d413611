// SPDX-License-Identifier: MIT
// The model that the arm is servoed with: the drawing, or a committed signature.
#pragma once

#include "core/signature.hpp"
#include "firmware/calibration/servo_inverse.hpp"
#include "firmware/controller/configuration.hpp"

namespace armsig::controller {

// Tool poses are of frame n moved to the tool point, in the frame R that the model is told in.
struct Model {
  kinematics::Chain chain;            // pseudo-DH (21), with the limits of what the joints may turn
  calibration::ServoReadings joints;  // how far they do for their readings
  Pose X_R0;                          // a signature: R is the sensor frame; the drawing: its base
  Vector3 p_nT = Vector3::Zero();     // the tool point in frame n
  bool identified = false;
};

// The drawing, its tool at the origin of its last frame.
[[nodiscard]] Model model_of(const Arm& drawing);
void make_model(const Arm& drawing, Model& model);

// A signature, its tool at its target on the hand. Made in place, as it is large. Precondition:
// calibration::check() accepts `deflections`.
void make_model(const Signature& signature, const calibration::PackedDeflections& deflections,
                const Arm& drawing, Model& model);
[[nodiscard]] Model model_of(const Signature& signature, const Arm& drawing);

// Tool pose in R at readings q. Errors: kNotFinite.
[[nodiscard]] Result<Pose> tool_pose(const Model& model, const JointVector& q);

// The readings, near `seed`, at which frame n is at X_0n; `lately`: what the inverse before found,
// where this one follows it. Errors: those of calibration::inverse().
[[nodiscard]] inline Result<kinematics::InverseSolution> joints_for(
    const Model& model, const Pose& X_0n, const JointVector& seed,
    const kinematics::InverseOptions& options, calibration::LatelyTurned& lately) {
  return calibration::inverse(model.chain, model.joints, X_0n, seed, options, lately);
}

// Pose of frame n in frame 0 for a tool pose in R, as the inverse wants it.
[[nodiscard]] inline Pose flange_pose(const Model& model, const Pose& X_RT) {
  const Pose X_0T = model.X_R0.inverse() * X_RT;
  return {X_0T.R, X_0T.p - X_0T.R * model.p_nT};
}

}  // namespace armsig::controller
