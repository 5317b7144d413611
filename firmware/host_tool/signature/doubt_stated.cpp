// SPDX-License-Identifier: MIT
#include "firmware/host_tool/signature/doubt_stated.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "core/base/low_discrepancy.hpp"
#include "core/calibration/row.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/library/estimate.hpp"

namespace armsig::tool {
namespace {

// Beyond so many sigmas a slide's scale is no chance, and beyond this nothing that a map may be.
constexpr double kSignificant = 5;
constexpr double kLeastSaid = 1e-3;
constexpr double kEither = 0.5;  // the reading or the sensor
// Directions that move the tool by less than this, of the one that moves it most, stay as they are.
constexpr double kToldByTool = 1e-4;

// What `factor` on all lengths does to the tool, base and tool fitted; empty without a target on
// the last link.
std::vector<Vector3> moved_by_scale(const SignatureRecord& record, double factor) {
  using Square = Eigen::Matrix<double, 6, 6>;
  using Column = Eigen::Matrix<double, 6, 1>;
  const Signature& signature = record.signature;
  const auto tool = tool_target(signature);
  if (!tool) return {};
  // A scale only stretches: no turn of the base undoes it, a shift and another tool do in part.
  Square squares = Square::Zero();
  Column gradient = Column::Zero();
  std::vector<Vector3> moved;
  std::vector<Eigen::Matrix<double, 3, 6>> undoing;
  for (int k = 1; k <= kJudgedConfigurations; ++k) {
    const JointVector q = work_configuration(signature.types, record.nominal.limits, k);
    moved.emplace_back((factor - 1) *
                       kinematics::target_position(signature, q, signature.targets[*tool]));
    undoing.emplace_back();
    undoing.back() << Matrix3::Identity(),
        kinematics::link_pose(signature, q, signature.joint_count()).R;
    squares += undoing.back().transpose() * undoing.back();
    gradient += undoing.back().transpose() * moved.back();
  }
  const Column best = squares.ldlt().solve(gradient);
  for (std::size_t k = 0; k < moved.size(); ++k) moved[k] -= undoing[k] * best;
  return moved;
}

// The unknowns of the estimate that move the tool like `moved`, as nearly as they can.
Eigen::VectorXd unknowns_that_move(const calibration::Refined& estimate,
                                   const FixedVector<JointLimits, kMaxJoints>& limits,
                                   std::size_t tool, const std::vector<Vector3>& moved,
                                   double& left_squares) {
  const auto size = static_cast<Eigen::Index>(estimate.layout.size());
  const auto numbers = 3 * static_cast<Eigen::Index>(moved.size());
  Eigen::MatrixXd J(numbers, size);
  Eigen::VectorXd d(numbers);
  const calibration::PoeChain chain(estimate.signature, estimate.readings);
  calibration::RowBlock<3> rows;
  for (Eigen::Index k = 0; k < numbers; k += 3) {
    const JointVector q =
        work_configuration(estimate.signature.types, limits, static_cast<int>(k / 3 + 1));
    (void)calibration::position_rows(estimate, chain, q, tool, rows);
    for (Eigen::Index i = 0; i < 3; ++i) {
      J.row(k + i) =
          Eigen::Map<const Eigen::RowVectorXd>(rows.rows[static_cast<std::size_t>(i)].data(), size);
    }
    d.segment<3>(k) = moved[static_cast<std::size_t>(k / 3)];
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(kToldByTool);
  Eigen::VectorXd x = solver.compute(J).solve(d);
  left_squares = (d - J * x).squaredNorm() / static_cast<double>(moved.size());
  return x;
}

// The covariance knows what is stated: one more direction in which the estimate may be off, and
// what no unknown can do like what is left unexplained in every pose.
void spread(SignatureRecord& record, double probability, const std::vector<Vector3>& moved) {
  const auto estimate = estimate_of(record, {});
  const auto tool = tool_target(record.signature);
  if (!estimate || !tool) return;
  double left_squares = 0;
  const Eigen::VectorXd x =
      unknowns_that_move(**estimate, record.nominal.limits, *tool, moved, left_squares);
  *record.covariance += probability * x * x.transpose();
  const calibration::Layout& layout = (*estimate)->layout;
  for (std::size_t t = 0; t < record.signature.targets.size(); ++t) {
    const Vector3 of_target = x.segment<3>(static_cast<Eigen::Index>(layout.target[t]));
    record.signature.targets[t].covariance_m2 += probability * of_target * of_target.transpose();
  }
  record.unexplained_m =
      std::sqrt(record.unexplained_m * record.unexplained_m + probability * left_squares / 3);
}

}  // namespace

double moved_by_scale_m(const SignatureRecord& record, double factor) {
  const std::vector<Vector3> moved = moved_by_scale(record, factor);
  return moved.empty() ? 0 : rms_length(moved);
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
  if (!(doubt.probability > 0) || !record.accuracy.predicted || record.warnings.empty()) return 0;
  const bool scale = doubt.lengths_factor != 1;
  const std::vector<Vector3> moved =
      scale ? moved_by_scale(record, doubt.lengths_factor) : doubt.tool_off_m;
  if (moved.empty()) return 0;
  const double off_m = rms_length(moved);
  record.warnings.back() += fmt::format(
      "; if {} the tool is off by {:.3f} mm{}: that is part of the predicted tool error, as "
      "probably as it is so",
      scale ? "it is the sensor's" : "so", 1e3 * off_m, scale ? ", base and tool fitted" : "");
  const double stated_m = std::sqrt(doubt.probability) * off_m;
  double& predicted_m = record.accuracy.predicted->rms_m;
  predicted_m = std::hypot(predicted_m, stated_m);
  spread(record, doubt.probability, moved);
  return stated_m;
}

}  // namespace armsig::tool
