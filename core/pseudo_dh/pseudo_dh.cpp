// SPDX-License-Identifier: MIT
#include "core/pseudo_dh/pseudo_dh.hpp"

namespace armsig::pseudo_dh {

DhRows from_s_model(const FixedVector<s_model::Parameters, kMaxJoints>& s_model,
                    const JointTypes& types, const JointVector& configuration) {
  ARMSIG_CHECK(types.size() == s_model.size() && configuration.size() == s_model.size());
  DhRows rows;
  // gamma_0 and b_0 belong to no frame: (22) and (23) leave them out.
  double gamma_before_rad = 0;
  double b_before_m = 0;
  for (std::size_t i = 0; i < s_model.size(); ++i) {
    const s_model::Parameters& s = s_model[i];
    const bool revolute = types[i] == JointType::kRevolute;
    const double theta_rad = s.beta_rad + gamma_before_rad;  // (9)
    const double d_m = s.d_m + b_before_m;                   // (10)
    DhJoint row;
    row.type = types[i];
    row.theta_rad = wrap_angle(revolute ? theta_rad - configuration[i] : theta_rad);  // (19)
    row.d_m = revolute ? d_m : d_m - configuration[i];                                // (19)
    row.a_m = s.a_m;                                                                  // (11)
    row.alpha_rad = s.alpha_rad;                                                      // (12)
    rows.push_back(row);
    gamma_before_rad = s.gamma_rad;
    b_before_m = s.b_m;
  }
  return rows;
}

Pose link_frame_in_dh_frame(const s_model::Parameters& parameters) {
  return {rotation_z(parameters.gamma_rad), Vector3(0, 0, parameters.b_m)};
}

}  // namespace armsig::pseudo_dh
