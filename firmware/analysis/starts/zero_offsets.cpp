// SPDX-License-Identifier: MIT
#include "firmware/analysis/starts/zero_offsets.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/numerics/robust.hpp"
#include "core/numerics/rotations.hpp"
#include "firmware/analysis/starts/base_and_targets.hpp"

namespace armsig::calibration {

namespace {

constexpr int kMostSteps = 60;
constexpr double kLargestDamping = 1e8;
// Of a step, in metres and radians, below which nothing more is gained.
constexpr double kLastStep = 1e-9;
// More than this is not left by lengths drawn wrong by centimetres.
constexpr double kGood_m = 0.1;
// Another quarter of a turn must explain the log that much better.
constexpr double kConvincingTurn = 0.5;
constexpr int kQuarterTurnedJoints = 3;

// Rotation and shift of the base, target, zeros.
constexpr int kUnknowns = 9 + static_cast<int>(kMaxJoints);
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;

void shift_zero(Arm& arm, std::size_t joint, double shift) {
  DhJoint& row = arm.joints[joint];
  (row.type == JointType::kRevolute ? row.theta_rad : row.d_m) += shift;
}

class ZeroFit {
 public:
  ZeroFit(const Arm& arm, const BaseAndTool& fitted, std::span<const Observation> log,
          std::span<const Target> targets)
      : arm_(arm),
        log_(log),
        targets_(targets),
        main_(fitted.main),
        at_{fitted.X_SB, fitted.p_LT} {}

  void run() {
    double damping = 1e-3;
    for (int step = 0; step < kMostSteps && damping < kLargestDamping; ++step) {
      const double scale = residual_scale(rows(), at_);
      linearise(scale);
      const double before = cost(scale);
      while (damping < kLargestDamping) {
        ZeroFit next = *this;
        const double length = next.move(damping);
        if (next.cost(scale) < before) {
          *this = next;
          damping = std::max(0.1 * damping, 1e-9);
          if (length < kLastStep) return;
          break;
        }
        damping *= 10;
      }
    }
  }

  [[nodiscard]] const Arm& arm() const { return arm_; }

 private:
  [[nodiscard]] DrawnRows rows() const { return {arm_, log_, targets_, main_}; }

  [[nodiscard]] double cost(double scale) const {
    double sum = 0;
    rows().for_each([&](const Observation& row, const Pose& X_BL) {
      sum += numerics::huber_loss(at_.residual(row, X_BL).norm(), scale);
    });
    return sum;
  }

  void linearise(double scale) {
    normal_.setZero();
    gradient_.setZero();
    rows().for_each_frames([&](const Observation& row, const auto& X_BF) {
      const Vector3 p_B = X_BF.back() * at_.p_LT[main_];
      const Vector3 turned = at_.X_SB.R * p_B;
      const Vector3 residual = row.p_S - at_.X_SB.p - turned;
      const double length = residual.norm();
      const double weight = numerics::huber_weight(length, scale);
      Eigen::Matrix<double, 3, kUnknowns> J = Eigen::Matrix<double, 3, kUnknowns>::Zero();
      for (int c = 0; c < 3; ++c) {
        J.col(c) = Vector3::Unit(c).cross(turned);
        J.col(3 + c) = Vector3::Unit(c);
      }
      J.template middleCols<3>(6) = at_.X_SB.R.lazyProduct(X_BF.back().R);
      for (std::size_t i = 0; i < arm_.joints.size(); ++i) {
        const Vector3 axis = X_BF[i].R.col(2);
        const bool revolute = arm_.joints[i].type == JointType::kRevolute;
        J.col(9 + static_cast<int>(i)) =
            at_.X_SB.R * (revolute ? Vector3(axis.cross(p_B - X_BF[i].p)) : axis);
      }
      normal_.noalias() += weight * J.transpose().lazyProduct(J);
      gradient_.noalias() += weight * J.transpose().lazyProduct(residual);
    });
  }

  // One damped step; returns its length. The zero of the first joint is the base's too, and that of
  // the last the target's: the damping decides between them.
  double move(double damping) {
    Normal damped = normal_;
    const double ridge = 1e-12 * normal_.trace();
    for (int k = 0; k < kUnknowns; ++k) damped(k, k) += damping * normal_(k, k) + ridge;
    const Unknowns x = damped.ldlt().solve(gradient_);
    at_.X_SB.R = numerics::rotation_by(x.head<3>()) * at_.X_SB.R;
    at_.X_SB.p += x.segment<3>(3);
    at_.p_LT[main_] += x.segment<3>(6);
    for (std::size_t i = 0; i < arm_.joints.size(); ++i) {
      shift_zero(arm_, i, x[9 + static_cast<int>(i)]);
    }
    return x.norm();
  }

  Arm arm_;
  std::span<const Observation> log_;
  std::span<const Target> targets_;
  std::size_t main_;
  BaseAndTargets at_;
  Normal normal_ = Normal::Zero();
  Unknowns gradient_ = Unknowns::Zero();
};

Judged<ZeroedDrawing> fit_from(const Arm& arm, std::span<const Observation> log,
                               std::span<const Target> targets) {
  ARMSIG_TRY(fitted, fit_base_and_tool(arm, log, targets));
  ZeroFit fit(arm, fitted, log, targets);
  fit.run();
  ARMSIG_TRY(refitted, fit_base_and_tool(fit.arm(), log, targets));
  return ZeroedDrawing{fit.arm(), {}, refitted};
}

}  // namespace

Judged<ZeroedDrawing> fit_zeros(const Arm& arm, std::span<const Observation> log,
                                std::span<const Target> targets) {
  ARMSIG_TRY(best, fit_from(arm, log, targets));
  Arm from = arm;
  for (int round = 0; round < kQuarterTurnedJoints && best.fitted.rms_m > kGood_m; ++round) {
    const double before_m = best.fitted.rms_m;
    Arm best_from = from;
    for (std::size_t joint = 0; joint < arm.joints.size(); ++joint) {
      if (arm.joints[joint].type != JointType::kRevolute) continue;
      for (const double quarters : {1, 2, 3}) {
        Arm trial_from = from;
        shift_zero(trial_from, joint, 0.5 * kPi * quarters);
        const auto trial = fit_from(trial_from, log, targets);
        if (!trial || trial->fitted.rms_m >= best.fitted.rms_m) continue;
        best = *trial;
        best_from = trial_from;
      }
    }
    if (best.fitted.rms_m > kConvincingTurn * before_m) break;
    from = best_from;
  }
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const bool revolute = arm.joints[i].type == JointType::kRevolute;
    const double shift = revolute ? best.arm.joints[i].theta_rad - arm.joints[i].theta_rad
                                  : best.arm.joints[i].d_m - arm.joints[i].d_m;
    best.shifts.push_back(revolute ? std::remainder(shift, 2 * kPi) : shift);
  }
  return best;
}

}  // namespace armsig::calibration
