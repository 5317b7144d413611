// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/tool_error_map.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "core/base/low_discrepancy.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/analysis/differences/differences.hpp"
#include "firmware/analysis/evaluation/geometry_alone.hpp"
#include "firmware/analysis/evaluation/tool_error.hpp"
#include "firmware/analysis/uncertainty/tool_covariance.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/library/estimate.hpp"

namespace armsig::tool {
namespace {

constexpr int kMapPoints = 600;
constexpr int kRmsConfigurations = 1000;
constexpr int kShareConfigurations = 40;

// Variance of the tool that each axis alone brings, by differences of a sigma of each unknown.
std::vector<double> joint_share(const SignatureRecord& record,
                                const FixedVector<JointLimits, kMaxJoints>& limits,
                                const calibration::Refined& estimate, std::size_t tool) {
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

// The region of the predicted error, so that it is held against the drawing's over the same poses.
// Maps say nothing of readings that were not measured.
PredictedRegion judged_region(const SignatureRecord& record) {
  const auto& predicted = record.accuracy.predicted;
  if (predicted && predicted->region != PredictedRegion::kSignatureConfiguration) {
    return predicted->region;
  }
  return record.deflections ? PredictedRegion::kMeasuredReadings : PredictedRegion::kJointLimits;
}

// The drawing, its joints limited to the region.
Arm judged_drawing(const SignatureRecord& record, PredictedRegion region) {
  Arm drawing = record.nominal;
  if (record.deflections && region == PredictedRegion::kMeasuredReadings) {
    drawing.limits = calibration::covered_limits(*record.deflections, drawing.limits);
  }
  return drawing;
}

// The drawing with base and tool fitted to the arm; with its axes laid over the arm's where it is
// another arm altogether.
Signature drawn_model(const Arm& drawing, const calibration::Refined& arm, std::size_t tool) {
  const auto fitted = differences::fitted_drawing(drawing, arm, tool);
  return fitted ? *fitted : evaluation::drawing_as_model(drawing, arm.signature);
}

// An arm that is known exactly.
std::unique_ptr<calibration::Refined> known(const Signature& signature,
                                            const calibration::ReadingModel& readings) {
  auto arm = std::make_unique<calibration::Refined>();
  arm->signature = signature;
  arm->readings = readings;
  return arm;
}

// Where the arm of a record has its target while the encoders read `q`.
Vector3 target_at(const SignatureRecord& arm, const Target& target, const JointVector& q) {
  const Signature& signature = arm.signature;
  return kinematics::target_position(
      signature, calibration::true_readings(arm.readings(), signature.configuration, q), target);
}

const Target* target_numbered(const Signature& signature, int number) {
  const auto* found = std::ranges::find(signature.targets, number, &Target::number);
  return found == signature.targets.end() ? nullptr : found;
}

// Where the drawing, laid over an arm as `drawn`, has it.
Vector3 drawn_target_at(const Signature& drawn, int number, const Arm& drawing,
                        const JointVector& q) {
  return kinematics::target_position(drawn, effective_readings(drawing, q),
                                     *target_numbered(drawn, number));
}

void compare_with_truth(const SignatureRecord& record, const Arm& drawing,
                        const SignatureRecord& truth, const Target& target, ToolErrorMap& map) {
  const Signature& arm = truth.signature;
  const Target* true_target = target_numbered(arm, target.number);
  if (true_target == nullptr) return;
  const auto index = static_cast<std::size_t>(true_target - arm.targets.begin());
  const Signature drawn = drawn_model(drawing, *known(arm, truth.readings()), index);
  double drawing_squares = 0;
  double squares = 0;
  for (int n = 1; n <= kRmsConfigurations; ++n) {
    const JointVector q = evenly_spread_configuration(arm.types, drawing.limits, n);
    const Vector3 p_S = target_at(truth, *true_target, q);
    drawing_squares += (drawn_target_at(drawn, target.number, drawing, q) - p_S).squaredNorm();
    squares += (target_at(record, target, q) - p_S).squaredNorm();
  }
  map.true_nominal_rms_m = std::sqrt(drawing_squares / kRmsConfigurations);
  map.true_rms_m = std::sqrt(squares / kRmsConfigurations);
}

Vector3 principal_variances(const Matrix3& covariance_m2) {
  const Eigen::SelfAdjointEigenSolver<Matrix3> axes(covariance_m2, Eigen::EigenvaluesOnly);
  return axes.eigenvalues().cwiseMax(0);
}

// Whether each joint reads what it has read before: revolute joints on whichever turn.
bool is_within(const FixedVector<JointLimits, kMaxJoints>& reach, const JointTypes& types,
               const JointVector& q) {
  if (reach.size() != q.size()) return true;
  for (std::size_t i = 0; i < q.size(); ++i) {
    const auto& [lower, upper] = reach[i];
    double reading = q[i];
    if (types[i] == JointType::kRevolute) {
      reading = lower + std::fmod(std::fmod(q[i] - lower, 2 * kPi) + 2 * kPi, 2 * kPi);
    }
    if (reading < lower || reading > upper) return false;
  }
  return true;
}

// The signature's error over the region, over all that the limits allow, and by joint.
void predict(const SignatureRecord& record, const calibration::Refined* estimate,
             PredictedRegion region, const FixedVector<JointLimits, kMaxJoints>& limits,
             std::size_t tool, ToolErrorMap& map) {
  const auto& predicted = record.accuracy.predicted;
  if (predicted && predicted->region == region) map.predicted_rms_m = predicted->rms_m;
  if (estimate != nullptr) {
    if (!map.predicted_rms_m) {
      map.predicted_rms_m = uncertainty::predicted_rms(*estimate, limits, tool);
    }
    if (region == PredictedRegion::kMeasuredReadings) {
      map.predicted_over_limits_m =
          uncertainty::predicted_rms(*estimate, record.nominal.limits, tool);
    }
    map.joint_share = joint_share(record, limits, *estimate, tool);
  }
}

}  // namespace

std::optional<ToolErrorMap> tool_error_map(const SignatureRecord& record,
                                           const calibration::Refined* estimate,
                                           const std::optional<SignatureRecord>& truth,
                                           const FixedVector<JointLimits, kMaxJoints>& measured) {
  const auto tool = tool_target(record.signature);
  if (!tool || record.nominal.limits.size() != record.signature.joint_count()) return std::nullopt;
  const Signature& signature = record.signature;
  const Target& target = signature.targets[*tool];
  const PredictedRegion region = judged_region(record);
  const Arm drawing = judged_drawing(record, region);
  const Signature drawn = drawn_model(drawing, *known(signature, record.readings()), *tool);
  ToolErrorMap map;
  map.over = region_in_words(region);
  double squares = 0;
  for (int n = 1; n <= kRmsConfigurations; ++n) {
    const JointVector q = evenly_spread_configuration(signature.types, drawing.limits, n);
    ToolErrorAt at;
    at.p_S = target_at(record, target, q);
    at.drawing_m = (drawn_target_at(drawn, target.number, drawing, q) - at.p_S).norm();
    squares += at.drawing_m * at.drawing_m;
    if (n > kMapPoints) continue;
    at.measured = is_within(measured, signature.types, q);
    if (estimate != nullptr) {
      at.variances_m2 = principal_variances(uncertainty::tool_covariance(*estimate, q, *tool));
      at.predicted_m = std::sqrt(at.variances_m2.sum());
    }
    map.points.push_back(at);
  }
  map.nominal_rms_m = std::sqrt(squares / kRmsConfigurations);
  predict(record, estimate, region, drawing.limits, *tool, map);
  if (truth) compare_with_truth(record, drawing, *truth, target, map);
  return map;
}

}  // namespace armsig::tool
