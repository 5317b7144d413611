// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/tool_error_map.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/low_discrepancy.hpp"
#include "core/calibration/geometry_alone.hpp"
#include "core/evaluation/differences.hpp"
#include "core/evaluation/tool_error.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "core/uncertainty/tool_covariance.hpp"
#include "firmware/host_tool/signature/estimate.hpp"

namespace armsig::tool {
namespace {

constexpr int kMapPoints = 600;
constexpr int kRmsConfigurations = 1000;
constexpr int kShareConfigurations = 40;

// Variance of the tool that each axis alone brings, by differences of a sigma of each unknown.
std::vector<double> joint_share(const SignatureRecord& record,
                                const FixedVector<JointLimits, kMaxJoints>& limits,
                                const refinement::Refined& estimate, std::size_t tool) {
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
        const JointVector q = evenly_spread_configuration(record.signature.types, limits, n);
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

// The drawing, its joints limited to what the signature was measured at, where that counts.
Arm judged_drawing(const SignatureRecord& record) {
  Arm drawing = record.nominal;
  if (record.deflections) {
    drawing.limits = calibration::covered_limits(*record.deflections, drawing.limits);
  }
  return drawing;
}

// The drawing with base and tool fitted to the arm; with its axes laid over the arm's where it is
// another arm altogether.
Signature drawn_model(const Arm& drawing, const refinement::Refined& arm, std::size_t tool) {
  const auto fitted = evaluation::fitted_drawing(drawing, arm, tool);
  return fitted ? *fitted : evaluation::drawing_as_model(drawing, arm.signature);
}

// An arm that is known exactly.
std::unique_ptr<refinement::Refined> known(const Signature& signature,
                                           const refinement::ReadingModel& readings) {
  auto arm = std::make_unique<refinement::Refined>();
  arm->signature = signature;
  arm->readings = readings;
  return arm;
}

void compare_with_truth(const SignatureRecord& record, const Arm& drawing, const Signature& truth,
                        int tool, ToolErrorMap& map) {
  const auto* found = std::ranges::find(truth.targets, tool, &Target::number);
  if (found == truth.targets.end()) return;
  const auto rms = [&](const Signature& model, const Pose& X_AM) {
    return evaluation::rms_tool_error(model, truth, tool, X_AM, drawing.limits, kRmsConfigurations);
  };
  const auto arm = known(truth, {.couplings = record.nominal.couplings, .corrections = {}});
  const auto index = static_cast<std::size_t>(found - truth.targets.begin());
  map.true_drawing_rms_m = rms(drawn_model(drawing, *arm, index), Pose{});
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
  const Arm drawing = judged_drawing(record);
  const Signature drawn = drawn_model(drawing, *known(signature, record.readings()), *tool);
  const auto* drawn_tool = std::ranges::find(drawn.targets, target.number, &Target::number);
  ToolErrorMap map;
  map.over = record.deflections ? "the readings measured" : "the joint limits";
  double squares = 0;
  for (int n = 1; n <= kRmsConfigurations; ++n) {
    const JointVector q = evenly_spread_configuration(signature.types, drawing.limits, n);
    ToolErrorAt at;
    const JointVector turned =
        refinement::true_readings(record.readings(), signature.configuration, q);
    at.p_S = kinematics::target_position(signature, turned, target);
    const Vector3 p_drawn =
        kinematics::target_position(drawn, effective_readings(record.nominal, q), *drawn_tool);
    at.drawing_m = (p_drawn - at.p_S).norm();
    squares += at.drawing_m * at.drawing_m;
    if (n > kMapPoints) continue;
    if (estimate != nullptr) {
      at.predicted_m = std::sqrt(uncertainty::tool_covariance(*estimate, q, *tool).trace());
    }
    map.points.push_back(at);
  }
  map.drawing_rms_m = std::sqrt(squares / kRmsConfigurations);
  map.predicted_rms_m = record.predicted_tool_error_m;
  if (estimate != nullptr) {
    if (!map.predicted_rms_m) {
      map.predicted_rms_m = uncertainty::predicted_rms(*estimate, drawing.limits, *tool);
    }
    map.joint_share = joint_share(record, drawing.limits, *estimate, *tool);
  }
  if (truth) compare_with_truth(record, drawing, *truth, target.number, map);
  return map;
}

}  // namespace armsig::tool
