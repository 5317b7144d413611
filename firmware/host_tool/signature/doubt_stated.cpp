// SPDX-License-Identifier: MIT
#include "firmware/host_tool/signature/scale_in_doubt.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <fmt/core.h>

#include "core/base/low_discrepancy.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/host_tool/signature/estimate.hpp"

namespace armsig::tool {
namespace {

constexpr int kJudged = 200;  // configurations, as uncertainty::predicted_rms()

}  // namespace

double moved_by_scale_m(const SignatureRecord& record, double factor) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  const Signature& signature = record.signature;
  const auto tool = tool_target(signature);
  if (!tool) return 0;
  // A scale only stretches: no turn of the base undoes it, a shift and another tool do in part.
  Matrix6 squares = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  double whole = 0;
  for (int k = 1; k <= kJudged; ++k) {
    const JointVector q = work_configuration(signature.types, record.nominal.limits, k);
    const Vector3 moved =
        (factor - 1) * kinematics::target_position(signature, q, signature.targets[*tool]);
    Eigen::Matrix<double, 3, 6> undone;
    undone << Matrix3::Identity(), kinematics::link_pose(signature, q, signature.joint_count()).R;
    squares += undone.transpose() * undone;
    gradient += undone.transpose() * moved;
    whole += moved.squaredNorm();
  }
  const Vector6 best = squares.ldlt().solve(gradient);
  return std::sqrt(std::max(0.0, whole - best.dot(gradient)) / kJudged);
}

void state_scale(SignatureRecord& record, double factor, double probability) {
  if (!(probability > 0) || !record.predicted_tool_error_m || record.warnings.empty()) return;
  const double moved_m = moved_by_scale_m(record, factor);
  record.warnings.back() += fmt::format(
      "; if it is the sensor's the tool is off by {:.3f} mm, base and tool fitted: that is part of "
      "the predicted tool error, as probably as it is so",
      1e3 * moved_m);
  record.predicted_tool_error_m =
      std::hypot(*record.predicted_tool_error_m, std::sqrt(probability) * moved_m);
}

}  // namespace armsig::tool
