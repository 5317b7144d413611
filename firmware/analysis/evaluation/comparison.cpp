// SPDX-License-Identifier: MIT
#include "firmware/analysis/evaluation/comparison.hpp"

#include <algorithm>
#include <optional>

#include "core/frames/alignment.hpp"
#include "core/identification.hpp"
#include "core/kinematics/forward.hpp"
#include "core/kinematics/s_model_chain.hpp"

namespace armsig::evaluation {
namespace {

const Target* last_link_target(const Signature& signature, std::optional<int> number = {}) {
  for (const Target& target : signature.targets) {
    if (target.link == signature.joint_count() && (!number || target.number == *number)) {
      return &target;
    }
  }
  return nullptr;
}

// The model whose tool is at p_S in its sensor frame when the arm is in the model's signature
// configuration.
Result<ToolModel> tool_model(const Signature& model,
                             const FixedVector<JointLimits, kMaxJoints>& limits,
                             const Vector3& p_S) {
  ToolModel tool{.chain = kinematics::make_chain(model.pseudo_dh, limits), .p_nT = {}};
  ARMSIG_TRY(X_0n, kinematics::forward(tool.chain, model.configuration));
  tool.p_nT = (model.X_SL[0] * X_0n).inverse() * p_S;
  return tool;
}

// The same arm, its link frames taken at other readings.
Signature reconfigured(const Signature& signature, const JointVector& q, const Arm& drawing) {
  Signature moved = signature;
  for (std::size_t k = 0; k < signature.X_SL.size(); ++k) {
    moved.X_SL[k] = kinematics::link_pose(signature, q, k);
  }
  for (Target& target : moved.targets) {
    target.p_S = kinematics::target_position(signature, q, target);
  }
  moved.configuration = q;
  derive_parameters(moved, drawing);
  return moved;
}

}  // namespace

std::array<double, 4> improvement(const Comparison& comparison, const Resolution& resolution) {
  const auto factor = [](double ideal, double with_signature, double step) {
    return std::max(ideal, step / 2) / std::max(with_signature, step / 2);
  };
  const Indices& a = comparison.ideal;
  const Indices& b = comparison.with_signature;
  // The least angle between lines that the machine resolves: one step of position over the longest
  // edge.
  const double longest_m =
      std::max({comparison.grid.size_m[0], comparison.grid.size_m[1], comparison.grid.size_m[2]});
  const double line_angle = resolution.position_m / longest_m;
  return {factor(a.normal_deviation_m, b.normal_deviation_m, resolution.position_m),
          factor(a.perpendicular_deviation_rad, b.perpendicular_deviation_rad, line_angle),
          factor(a.radial_deviation_m, b.radial_deviation_m, resolution.position_m),
          factor(a.orientation_deviation_rad, b.orientation_deviation_rad, resolution.angle_rad)};
}

Result<Comparison> compare(const Arm& drawing, const Signature& signature, const Signature& truth,
                           const Grid& grid, const Turning& of_signature, const Turning& of_truth) {
  const JointVector& configuration = signature.configuration;
  const Signature ideal = signature_of(drawing, configuration, Pose{}, {});
  const Signature actual = reconfigured(truth, turned(of_truth, configuration), drawing);
  // Sensor frames of signature (S) and truth (A), base frame of the drawing (D).
  const Pose X_DA = frames::align(frames::axis_lines(ideal), frames::axis_lines(actual)).X_AB;
  const Pose X_SA = frames::align(frames::axis_lines(signature), frames::axis_lines(actual)).X_AB;

  Vector3 p_S = X_SA * X_DA.inverse() * ideal.X_SL.back().p;
  Vector3 p_A = X_DA.inverse() * ideal.X_SL.back().p;
  if (const Target* measured = last_link_target(signature)) {
    const Target* known = last_link_target(actual, measured->number);
    p_S = measured->p_S;
    p_A = known != nullptr ? known->p_S : Vector3(X_SA.inverse() * p_S);
  }

  ARMSIG_TRY(through_drawing, tool_model(ideal, drawing.limits, X_DA * p_A));
  ARMSIG_TRY(through_signature, tool_model(signature, drawing.limits, p_S));
  ARMSIG_TRY(arm, tool_model(actual, drawing.limits, p_A));
  ARMSIG_TRY(placement, place_grid(through_drawing, grid));
  ARMSIG_TRY(ideal_readings, touch_grid(through_drawing, arm, placement, {}, of_truth));
  ARMSIG_TRY(signature_readings,
             touch_grid(through_signature, arm, placement, of_signature, of_truth));
  quantise(ideal_readings, Resolution{});
  quantise(signature_readings, Resolution{});
  return Comparison{.ideal = indices(placement.grid, ideal_readings),
                    .with_signature = indices(placement.grid, signature_readings),
                    .grid = placement.grid};
}

}  // namespace armsig::evaluation
