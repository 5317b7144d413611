// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/tool_error_map.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/low_discrepancy.hpp"
#include "core/evaluation/tool_error.hpp"
#include "core/frames/alignment.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "core/uncertainty/tool_covariance.hpp"
#include "firmware/host_tool/estimate.hpp"

namespace armsig::tool {
namespace {

constexpr int kMapPoints = 600;
constexpr int kRmsConfigurations = 1000;
constexpr int kShareConfigurations = 40;

// Variance of the tool that each axis alone brings, by differences of a sigma of each unknown.
std::vector<double> joint_share(const SignatureRecord& record, const refinement::Refined& estimate,
                                std::size_t tool) {
  const Eigen::MatrixXd covariance = covariance_of(estimate);
  std::vector<double> variance(record.signature.joint_count(), 0.0);
  for (std::size_t joint = 0; joint < variance.size(); ++joint) {
    const auto first = static_cast<Eigen::Index>(estimate.layout.axis[joint]);
    const Eigen::Index size = record.signature.types[joint] == JointType::kRevolute ? 4 : 2;
    const Eigen::MatrixXd block = covariance.block(first, first, size, size);
    const Eigen::MatrixXd half = block.llt().matrixL();
    for (Eigen::Index c = 0; c < size; ++c) {
      Eigen::VectorXd step = Eigen::VectorXd::Zero(covariance.rows());
      step.segment(first, size) = half.col(c);
      const Signature shifted = moved(estimate, record.nominal, step);
      for (int n = 1; n <= kShareConfigurations; ++n) {
        const JointVector q =
            evenly_spread_configuration(record.signature.types, record.nominal.limits, n);
        variance[joint] +=
            (kinematics::target_position(shifted, q, shifted.targets[tool]) -
             kinematics::target_position(record.signature, q, record.signature.targets[tool]))
                .squaredNorm();
      }
    }
  }
  double sum = 0;
  for (const double share : variance) sum += share;
  if (sum > 0) std::ranges::for_each(variance, [&](double& share) { share /= sum; });
  return variance;
}

void compare_with_truth(const SignatureRecord& record, const Signature& truth, int tool,
                        ToolErrorMap& map) {
  const bool has_tool = std::ranges::any_of(
      truth.targets, [&](const Target& target) { return target.number == tool; });
  if (!has_tool) return;
  const auto rms = [&](const Signature& model, const Pose& X_AM) {
    return evaluation::rms_tool_error(model, truth, tool, X_AM, record.nominal.limits,
                                      kRmsConfigurations);
  };
  map.true_drawing_rms_m = rms(evaluation::drawing_as_model(record.nominal, truth), Pose{});
  map.true_rms_m = rms(record.signature, Pose{});
}

}  // namespace

std::optional<ToolErrorMap> tool_error_map(const SignatureRecord& record,
                                           const refinement::Refined* estimate,
                                           const std::optional<Signature>& truth) {
  const auto tool = tool_target(record.signature);
  if (!tool || record.nominal.limits.size() != record.signature.joint_count()) return std::nullopt;
  const Signature& signature = record.signature;
  const Target& target = signature.targets[*tool];
  const Signature drawn = evaluation::drawing_as_model(record.nominal, signature);
  ToolErrorMap map;
  for (int n = 1; n <= kMapPoints; ++n) {
    const JointVector q = evenly_spread_configuration(signature.types, record.nominal.limits, n);
    ToolErrorAt at;
    const JointVector turned =
        refinement::true_readings(record.readings(), signature.configuration, q);
    at.p_S = kinematics::target_position(signature, turned, target);
    const Vector3 p_drawn = kinematics::target_position(
        drawn, effective_readings(record.nominal, q), drawn.targets[*tool]);
    at.drawing_m = (p_drawn - at.p_S).norm();
    if (estimate != nullptr) {
      at.predicted_m = std::sqrt(uncertainty::tool_covariance(*estimate, q, *tool).trace());
    }
    map.points.push_back(at);
  }
  map.drawing_rms_m = evaluation::rms_tool_error(drawn, signature, target.number, Pose{},
                                                 record.nominal.limits, kRmsConfigurations);
  map.predicted_rms_m = record.predicted_tool_error_m;
  if (estimate != nullptr) {
    if (!map.predicted_rms_m) {
      map.predicted_rms_m = uncertainty::predicted_rms(*estimate, record.nominal.limits, *tool);
    }
    map.joint_share = joint_share(record, *estimate, *tool);
  }
  if (truth) compare_with_truth(record, *truth, target.number, map);
  return map;
}

}  // namespace armsig::tool
