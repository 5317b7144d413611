// SPDX-License-Identifier: MIT
#include "firmware/linuxcnc/kins.hpp"

#include "core/base/couplings.hpp"
#include "firmware/linuxcnc/roll_pitch_yaw.hpp"

namespace armsig::linuxcnc {
namespace {

using kinematics::Verdict;

constexpr double kMillimetresPerMetre = 1e3;

// Degrees or millimetres per radian or metre.
double unit_of(JointType type) {
  return type == JointType::kRevolute ? degrees(1.0) : kMillimetresPerMetre;
}

Pose pose_of(const WorldPose& world) {
  const Vector3& abc = world.abc_deg;
  return {rotation_of({radians(abc.x()), radians(abc.y()), radians(abc.z())}),
          world.p_mm / kMillimetresPerMetre};
}

std::string_view refusal_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kConverged:
    case Verdict::kDegraded:
      return {};
    case Verdict::kJointLimit:
      return "a joint limit is in the way";
    case Verdict::kOutOfReach:
      return "out of reach";
    case Verdict::kStepLimit:
    case Verdict::kNotConverged:
      break;
  }
  return "no solution found near where the arm is";
}

Arm with_effective_limits(const KinsModel& model) {
  Arm arm = model.arm;
  arm.limits = effective_limits(model.arm);
  return arm;
}

calibration::ServoReadings readings_of(const KinsModel& model) {
  if (model.deflections.empty()) return {};
  Arm drawing = with_effective_limits(model);
  drawing.joints = model.drawn;
  return {model.deflections, drawing, model.configuration};
}

}  // namespace

Kins::Kins(const KinsModel& model, const Vector3& p_nT)
    : count_(model.arm.joints.size()),
      arm_(model.arm),
      readings_(readings_of(model)),
      chain_(kinematics::make_chain(model.arm.joints, readings_.exact()
                                                          ? effective_limits(model.arm)
                                                          : readings_.turned_limits())),
      X_nT_{model.X_nL.R, p_nT},
      X_Tn_(X_nT_.inverse()) {}

JointVector Kins::effective_of(std::span<const double> joints) const {
  JointVector readings;
  for (std::size_t i = 0; i < count_; ++i) {
    readings.push_back(joints[i] / unit_of(arm_.joints[i].type));
  }
  return effective_readings(arm_, readings);
}

bool Kins::forward(std::span<const double> joints, WorldPose& pose) const {
  const auto turned = readings_.turned(effective_of(joints));
  if (!turned) return false;
  const auto X_0n = kinematics::forward(chain_, *turned);
  if (!X_0n) return false;
  const Pose X_0T = *X_0n * X_nT_;
  const RollPitchYaw angles = roll_pitch_yaw(X_0T.R);
  pose.p_mm = kMillimetresPerMetre * X_0T.p;
  pose.abc_deg = {degrees(angles.roll_rad), degrees(angles.pitch_rad), degrees(angles.yaw_rad)};
  return true;
}

KinsAnswer Kins::inverse(const WorldPose& pose, std::span<double> joints) const {
  const kinematics::InverseOptions at_tool{.p_nP = X_nT_.p};
  const auto solution =
      calibration::inverse(chain_, readings_, pose_of(pose) * X_Tn_, effective_of(joints), at_tool);
  if (!solution) return {.refusal = describe(solution.error())};
  KinsAnswer answer{.refusal = refusal_of(solution->verdict), .regularity = solution->regularity};
  if (!answer.refusal.empty()) return answer;
  const JointVector readings = readings_for(arm_.couplings, solution->q);
  if (!inside_limits(readings)) {
    return {.refusal = "a joint limit is in the way", .regularity = solution->regularity};
  }
  answer.missed_rad = solution->rotation_error_rad;
  for (std::size_t i = 0; i < count_; ++i) joints[i] = unit_of(arm_.joints[i].type) * readings[i];
  return answer;
}

bool Kins::inside_limits(const JointVector& readings) const {
  constexpr double kAtLimit = 1e-9;  // limits are met exactly but for rounding
  for (std::size_t i = 0; i < count_; ++i) {
    const auto [lower, upper] = arm_.limits[i];
    if (!(readings[i] >= lower - kAtLimit && readings[i] <= upper + kAtLimit)) return false;
  }
  return true;
}

}  // namespace armsig::linuxcnc
