// SPDX-License-Identifier: MIT
#include "firmware/host_tool/exports/dh_rows.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "core/base/links.hpp"
#include "core/base/low_discrepancy.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "core/pseudo_dh/pseudo_dh.hpp"
#include "firmware/host_tool/exports/export.hpp"
#include "firmware/host_tool/exports/provenance.hpp"

namespace armsig::tool {
namespace {

constexpr int kConfigurationsChecked = 64;

double largest_difference_m(const StandardRows& standard, const SignatureRecord& record) {
  const Signature& signature = record.signature;
  double largest = 0;
  for (int n = 1; n <= kConfigurationsChecked; ++n) {
    const JointVector q = evenly_spread_configuration(signature.types, record.nominal.limits, n);
    const Pose X = standard.X_S0 * dh_frames(standard.rows, q).back() * standard.X_FL;
    const Pose exact = kinematics::link_pose(signature, q, signature.joint_count());
    largest = std::max(largest, (X.p - exact.p).norm());
  }
  return largest;
}

}  // namespace

Read<StandardRows> standard_rows(std::string_view format, const SignatureRecord& record) {
  const Signature& signature = record.signature;
  StandardRows standard{signature.pseudo_dh, signature.X_SL[0], Pose{}};
  standard.X_FL = pseudo_dh::link_frame_in_dh_frame(signature.s_model.back());
  const double difference_m = largest_difference_m(standard, record);
  if (difference_m > kExportTolerance_m) {
    return cannot_hold(
        format,
        fmt::format("two axes are so nearly parallel that rows in double precision are wrong by "
                    "{:.2g} m",
                    difference_m),
        "urdf, ur-yaml or json, which hold the axes themselves");
  }
  return standard;
}

ModifiedRows modified_rows(const StandardRows& standard) {
  ModifiedRows modified{{}, standard.X_S0, Pose{}};
  double alpha_prev_rad = 0;
  double a_prev_m = 0;
  for (const DhJoint& row : standard.rows) {
    modified.rows.push_back({row.type, alpha_prev_rad, a_prev_m, row.theta_rad, row.d_m});
    alpha_prev_rad = row.alpha_rad;
    a_prev_m = row.a_m;
  }
  modified.X_FL = Pose{rotation_x(alpha_prev_rad), Vector3(a_prev_m, 0, 0)} * standard.X_FL;
  return modified;
}

}  // namespace armsig::tool
