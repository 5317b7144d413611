// SPDX-License-Identifier: MIT
// The model that the arm is servoed with: the drawing, or a committed signature.
#pragma once

#include "core/kinematics/chain.hpp"
#include "core/signature.hpp"
#include "firmware/controller/configuration.hpp"

namespace armsig::controller {

// Tool poses are of frame n moved to the tool point, in the frame R that the model is told in.
struct Model {
  kinematics::Chain chain;         // pseudo-DH (21), with the joint limits
  Pose X_R0;                       // a signature: R is the sensor frame; the drawing: its base
  Vector3 p_nT = Vector3::Zero();  // the tool point in frame n
  bool identified = false;
};

// The drawing, its tool at the origin of its last frame.
[[nodiscard]] Model model_of(const Arm& drawing);

// A signature, its tool at its target on the hand.
[[nodiscard]] Model model_of(const Signature& signature, const Arm& drawing);

// Tool pose in R at readings q. Errors: kNotFinite.
[[nodiscard]] Result<Pose> tool_pose(const Model& model, const JointVector& q);

// Pose of frame n in frame 0 for a tool pose in R, as the inverse wants it.
[[nodiscard]] inline Pose flange_pose(const Model& model, const Pose& X_RT) {
  const Pose X_0T = model.X_R0.inverse() * X_RT;
  return {X_0T.R, X_0T.p - X_0T.R * model.p_nT};
}

}  // namespace armsig::controller
