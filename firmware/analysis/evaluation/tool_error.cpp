// SPDX-License-Identifier: MIT
#include "firmware/analysis/evaluation/tool_error.hpp"

#include <cmath>

#include "core/base/low_discrepancy.hpp"
#include "core/frames/alignment.hpp"
#include "core/identification.hpp"
#include "core/kinematics/s_model_chain.hpp"

namespace armsig::evaluation {
namespace {

const Target& target_of(const Signature& signature, int number) {
  for (const Target& target : signature.targets) {
    if (target.number == number) return target;
  }
  ARMSIG_CHECK(false);
}

}  // namespace

double rms_tool_error(const Signature& model, const Signature& arm, int target, const Pose& X_AM,
                      const FixedVector<JointLimits, kMaxJoints>& limits, int count) {
  const Target& in_model = target_of(model, target);
  const Target& in_arm = target_of(arm, target);
  double sum_m2 = 0;
  for (int n = 1; n <= count; ++n) {
    const JointVector q = evenly_spread_configuration(arm.types, limits, n);
    const Vector3 p_M = kinematics::target_position(model, q, in_model);
    sum_m2 += (X_AM * p_M - kinematics::target_position(arm, q, in_arm)).squaredNorm();
  }
  return std::sqrt(sum_m2 / count);
}

Signature drawing_as_model(const Arm& drawing, const Signature& arm) {
  const Signature drawn = signature_of(drawing, arm.configuration, Pose{}, {});
  const Pose X_AD = frames::align(frames::axis_lines(arm), frames::axis_lines(drawn)).X_AB;
  Signature model = signature_of(drawing, arm.configuration, X_AD, {});
  model.targets = arm.targets;
  return model;
}

}  // namespace armsig::evaluation
