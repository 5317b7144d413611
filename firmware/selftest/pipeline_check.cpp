// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "core/features/sweep_estimator.hpp"
#include "core/identification.hpp"
#include "core/kinematics/forward.hpp"
#include "firmware/selftest/checks.hpp"
#include "firmware/selftest/scratch.hpp"
#include "firmware/selftest/values.hpp"

namespace armsig::selftest {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// Step by step and without copies, as a controller does: the objects are too large for a stack.
bool measure(const std::array<SweptPoint, kPoints>& sweep, features::Method method,
             Signature& signature) {
  static std::optional<features::SweepEstimation> estimation;
  const Matrix3 covariance_m2 = 1e-8 * Matrix3::Identity();  // 0.1 mm; the points are exact
  auto& estimator = in_scratch<features::SweepEstimator>(
      features::SweepConfig{.type = JointType::kRevolute, .limits = {}, .method = method});
  for (const SweptPoint& point : sweep) {
    if (!estimator.add(point.reading, vector(point.p_S), covariance_m2)) return false;
  }
  estimation.emplace(estimator);
  while (estimation->step()) {
  }
  if (!estimation->result()) return false;
  signature.features.push_back(*estimation->result());
  return true;
}

bool identified(Signature& signature) {
  Arm drawing;
  drawing.joints = rows(kSwept.drawing, kSweptJoints);
  drawing.limits.resize(kSweptJoints, {-2 * kPi, 2 * kPi});
  auto& identification = in_scratch<Identification>(signature, drawing);
  for (;;) {
    const auto more = identification.step();
    if (!more || !*more) return more.has_value();
  }
}

// Worst distance of the target from where the signature predicts it; infinite: no signature.
double worst_prediction_m(features::Method method) {
  static Signature signature;
  const JointVector q_s = readings(kSwept.configuration, kSweptJoints);
  signature.features.clear();
  signature.configuration = q_s;
  for (const auto& sweep : kSwept.sweeps) {
    if (!measure(sweep, method, signature)) return kNever;
  }
  if (!identified(signature)) return kNever;

  const kinematics::Chain chain = kinematics::make_chain(signature.pseudo_dh);
  const auto X_0n = kinematics::forward(chain, q_s);
  if (!X_0n) return kNever;
  const Vector3 p_n = (signature.X_SL[0] * *X_0n).inverse() * vector(kSwept.target_S);
  double worst = 0;
  for (const HeldOutPose& pose : kSwept.held_out) {
    const auto X = kinematics::forward(chain, readings(pose.q, kSweptJoints));
    if (!X) return kNever;
    worst = std::max(worst, (signature.X_SL[0] * (*X * p_n) - vector(pose.p_S)).norm());
  }
  return worst;
}

}  // namespace

void check_pipeline(Report& report) {
  report.check("pipeline_encoder_nm", 1e9 * worst_prediction_m(features::Method::kEncoder), 1);
  report.check("pipeline_paper_nm", 1e9 * worst_prediction_m(features::Method::kPaper), 1);
}

}  // namespace armsig::selftest
