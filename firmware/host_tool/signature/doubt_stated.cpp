// SPDX-License-Identifier: MIT
#include "firmware/host_tool/signature/doubt_stated.hpp"

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
// Beyond so many sigmas a slide's scale is no chance, and beyond this nothing that a map may be.
constexpr double kSignificant = 5;
constexpr double kLeastSaid = 1e-3;
constexpr double kEither = 0.5;  // the reading or the sensor

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

std::optional<Doubt> doubt_of_slide(const Signature& signature) {
  for (std::size_t j = 0; j < signature.features.size(); ++j) {
    const features::SweepQuality& quality = signature.features[j].quality;
    const double off = std::abs(quality.encoder_ratio - 1);
    if (signature.types[j] != JointType::kPrismatic || off < kLeastSaid ||
        off < kSignificant * quality.encoder_ratio_sigma) {
      continue;
    }
    return Doubt{.what = fmt::format("joint {} is seen to go {:.4f} times as far as it reads, "
                                     "which is its reading's error or all lengths that are seen",
                                     j + 1, quality.encoder_ratio),
                 .cause = {},
                 .expected = "look at the lead of the joint, and at the scale of the sensor",
                 .refuses = false,
                 .probability = kEither,
                 .lengths_factor = quality.encoder_ratio};
  }
  return std::nullopt;
}

double state_doubt(SignatureRecord& record, const Doubt& doubt) {
  if (!(doubt.probability > 0) || !record.predicted_tool_error_m || record.warnings.empty())
    return 0;
  const bool scale = doubt.lengths_factor != 1;
  const double off_m = scale ? moved_by_scale_m(record, doubt.lengths_factor) : doubt.tool_off_m;
  record.warnings.back() += fmt::format(
      "; if {} the tool is off by {:.3f} mm{}: that is part of the predicted tool error, as "
      "probably as it is so",
      scale ? "it is the sensor's" : "so", 1e3 * off_m, scale ? ", base and tool fitted" : "");
  const double stated_m = std::sqrt(doubt.probability) * off_m;
  record.predicted_tool_error_m = std::hypot(*record.predicted_tool_error_m, stated_m);
  return stated_m;
}

}  // namespace armsig::tool
