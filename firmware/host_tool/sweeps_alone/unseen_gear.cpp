// SPDX-License-Identifier: MIT
#include "firmware/host_tool/sweeps_alone/unseen_gear.hpp"

#include <cmath>

#include "core/base/low_discrepancy.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"
#include "firmware/library/estimate.hpp"

namespace armsig::tool {
namespace {

// Of the predicted tool error: less of it does not matter beside it.
constexpr double kWorthNaming = 0.5;

// What the tool does per unit of a gear, seen from the signature configuration; RMS.
double moved_by_gear_m(const SignatureRecord& record, std::size_t joint, const Target& tool) {
  const Signature& signature = record.signature;
  double squares = 0;
  for (int k = 1; k <= kJudgedConfigurations; ++k) {
    const JointVector q = work_configuration(signature.types, record.nominal.limits, k);
    const Pose X_SJ = kinematics::link_pose(signature, q, joint);
    const Vector3 arm = kinematics::target_position(signature, q, tool) - X_SJ.p;
    const double turn = q[joint] - signature.configuration[joint];
    squares += (turn * X_SJ.R.col(2).cross(arm)).squaredNorm();
  }
  return std::sqrt(squares / kJudgedConfigurations);
}

}  // namespace

std::optional<UnseenGear> least_seen_gear(const SignatureRecord& record) {
  const Signature& signature = record.signature;
  const auto tool = tool_target(signature);
  if (!tool || !record.accuracy.predicted) return std::nullopt;
  UnseenGear least{.moved_m = kWorthNaming * record.accuracy.predicted->rms_m};
  for (std::size_t j = 0; j < signature.features.size(); ++j) {
    const bool corrected = j < record.corrections.size() && record.corrections[j].gain != 0;
    if (signature.types[j] != JointType::kRevolute || corrected) continue;
    const double sigma = signature.features[j].quality.encoder_ratio_sigma;
    const double moved_m = sigma * moved_by_gear_m(record, j, signature.targets[*tool]);
    if (moved_m > least.moved_m) least = {j, sigma, moved_m};
  }
  if (least.sigma == 0) return std::nullopt;
  return least;
}

}  // namespace armsig::tool
