// SPDX-License-Identifier: MIT
#include "firmware/host_tool/taught_frames/found_poses.hpp"

#include <algorithm>
#include <cmath>

#include "core/calibration/chain.hpp"
#include "core/calibration/model.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/library/estimate.hpp"
#include "firmware/library/joint_frames.hpp"

namespace armsig::tool {
namespace {

// Share of a sigma that a derivative is taken over: small beside curvature, large beside rounding.
constexpr double kShareOfSigma = 1e-2;
constexpr double kMotionStep = 1e-5;  // rad or m, of a joint
// Errors of a joint error map at readings nearer than the support of a spline belong together.
constexpr double kKnotsTogether = calibration::kSplines;

void write_difference(const Pose& above, const Pose& below, double step, Eigen::MatrixXd& to,
                      Eigen::Index row, Eigen::Index column) {
  to.block<3, 1>(row, column) = (above.p - below.p) / step;
  to.block<3, 1>(row + 3, column) = rotation_vector(above.R * below.R.transpose()) / step;
}

// The arm with one unknown moved.
struct MovedArm {
  Signature signature;
  FoundFlange flange;
};

MovedArm moved_arm(const calibration::Refined& estimate, const ControllerFrames& controller,
                   std::size_t unknown, double by) {
  calibration::StateVector x{};
  x.at(unknown) = by;
  Signature signature = estimate.signature;
  calibration::ReadingModel readings = estimate.readings;
  calibration::apply_corrections(estimate.layout, x, 1.0, signature, readings);
  return {signature, FoundFlange(signature, readings, controller)};
}

void add_unknown(const calibration::Refined& estimate, const ControllerFrames& controller,
                 const std::vector<JointVector>& rows, std::optional<std::size_t> target,
                 Eigen::Index unknown, PoseDerivatives& derivatives) {
  const auto k = static_cast<std::size_t>(unknown);
  const double h = kShareOfSigma * std::sqrt(derivatives.covariance(unknown, unknown));
  if (!(h > 0)) return;
  const MovedArm above = moved_arm(estimate, controller, k, h);
  const MovedArm below = moved_arm(estimate, controller, k, -h);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    write_difference(above.flange.pose(rows[n]), below.flange.pose(rows[n]), 2 * h,
                     derivatives.by_unknowns, static_cast<Eigen::Index>(6 * n), unknown);
  }
  if (!target) return;
  derivatives.tip_by_unknowns.col(unknown) =
      (above.flange.target_E(above.signature.targets[*target]) -
       below.flange.target_E(below.signature.targets[*target])) /
      (2 * h);
}

// Of the errors of one joint's map at the readings of the rows.
Eigen::MatrixXd map_covariance_of(const calibration::JointModel& joint, std::size_t index,
                                  const std::vector<JointVector>& rows) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd covariance(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double at_i = rows[static_cast<std::size_t>(i)][index];
    const double variance_i = calibration::map_variance_at(joint, at_i);
    for (Eigen::Index j = 0; j < count; ++j) {
      const double at_j = rows[static_cast<std::size_t>(j)][index];
      const double apart =
          joint.type == JointType::kRevolute ? wrap_angle(at_i - at_j) : at_i - at_j;
      const double knots = std::abs(apart) * joint.domain.per_length;
      covariance(i, j) = std::max(0.0, 1 - knots / kKnotsTogether) *
                         std::sqrt(variance_i * calibration::map_variance_at(joint, at_j));
    }
  }
  return covariance;
}

void add_maps(const calibration::Refined& estimate, const FoundFlange& flange,
              const std::vector<JointVector>& rows, PoseDerivatives& derivatives) {
  if (estimate.readings.deflections == nullptr) return;
  for (std::size_t i = 0; i < estimate.signature.joint_count(); ++i) {
    const calibration::JointModel& joint = estimate.readings.deflections->joints[i];
    if (!(joint.domain.per_length > 0)) continue;
    Eigen::MatrixXd by = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(6 * rows.size()),
                                               static_cast<Eigen::Index>(rows.size()));
    for (std::size_t n = 0; n < rows.size(); ++n) {
      write_difference(flange.pose(rows[n], i, kMotionStep), flange.pose(rows[n], i, -kMotionStep),
                       2 * kMotionStep, by, static_cast<Eigen::Index>(6 * n),
                       static_cast<Eigen::Index>(n));
    }
    derivatives.by_motion.push_back(std::move(by));
    derivatives.map_covariance.push_back(map_covariance_of(joint, i, rows));
  }
}

}  // namespace

FoundFlange::FoundFlange(const Signature& signature, const calibration::ReadingModel& readings,
                         const ControllerFrames& controller)
    : signature_(signature), readings_(readings) {
  const JointFrames frames = joint_frames(signature, controller.nominal);
  X_CS_ = (frames.X_SB * controller.X_0C).inverse();
  X_LE_ = signature.X_SL.back().inverse() * flange_in_sensor(frames, controller.nominal) *
          controller.X_nE;
}

Pose FoundFlange::pose(const JointVector& q, std::size_t joint, double by) const {
  JointVector turned = calibration::true_readings(readings_, signature_.configuration, q);
  turned[joint] += by;
  return X_CS_ * kinematics::link_pose(signature_, turned, signature_.joint_count()) * X_LE_;
}

Vector3 FoundFlange::target_E(const Target& target) const {
  return (signature_.X_SL.back() * X_LE_).inverse() * target.p_S;
}

Eigen::Matrix<double, 6, 6> PoseDerivatives::covariance_of(
    const Eigen::MatrixXd& by_rows, const Eigen::Matrix<double, 6, 3>& by_tip) const {
  const Eigen::MatrixXd by = by_rows * by_unknowns + by_tip * tip_by_unknowns;
  Eigen::Matrix<double, 6, 6> of = by * covariance * by.transpose();
  for (std::size_t i = 0; i < by_motion.size(); ++i) {
    const Eigen::MatrixXd by_map = by_rows * by_motion[i];
    of += by_map * map_covariance[i] * by_map.transpose();
  }
  return of;
}

PoseDerivatives pose_derivatives(const calibration::Refined& estimate,
                                 const ControllerFrames& controller,
                                 const std::vector<JointVector>& rows,
                                 std::optional<std::size_t> target) {
  PoseDerivatives derivatives;
  derivatives.covariance = covariance_of(estimate);
  derivatives.unexplained_m = estimate.quality.unexplained_m;
  const Eigen::Index unknowns = derivatives.covariance.rows();
  derivatives.by_unknowns =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(6 * rows.size()), unknowns);
  derivatives.tip_by_unknowns = Eigen::MatrixXd::Zero(3, unknowns);
  for (Eigen::Index k = 0; k < unknowns; ++k) {
    add_unknown(estimate, controller, rows, target, k, derivatives);
  }
  add_maps(estimate, FoundFlange(estimate.signature, estimate.readings, controller), rows,
           derivatives);
  return derivatives;
}

}  // namespace armsig::tool
