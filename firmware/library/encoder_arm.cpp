// SPDX-License-Identifier: MIT
#include "firmware/library/encoder_arm.hpp"

#include "core/kinematics/forward.hpp"

namespace armsig::tool {

EncoderArm::EncoderArm(const Parts& parts)
    : parts_(parts),
      form_(kinematics::closed_form(parts.chain)),
      X_0B_(parts.X_B0.inverse()),
      X_Fn_(parts.X_nF.inverse()) {}

Result<Pose> EncoderArm::forward(const JointVector& readings) const {
  ARMSIG_TRY(X_0n, kinematics::forward(parts_.chain,
                                       calibration::true_readings(parts_.readings,
                                                                  parts_.configuration, readings)));
  return parts_.X_B0 * X_0n * parts_.X_nF;
}

// Frames of a file are rotations to as many digits as were written.
Pose EncoderArm::last_frame(const Pose& X_BF) const {
  Pose X_0n = X_0B_ * X_BF * X_Fn_;
  X_0n.R = Eigen::Quaterniond(X_0n.R).normalized().toRotationMatrix();
  return X_0n;
}

kinematics::InverseOptions EncoderArm::options(const Vector3& p_FT) const {
  return {.p_nP = parts_.X_nF * p_FT};
}

bool EncoderArm::inside_limits(const JointVector& readings) const {
  constexpr double kAtLimit = 1e-9;
  for (std::size_t i = 0; i < parts_.limits.size(); ++i) {
    const auto [lower, upper] = parts_.limits[i];
    if (!(readings[i] >= lower - kAtLimit && readings[i] <= upper + kAtLimit)) return false;
  }
  return true;
}

// The limits of coupled joints are those of their own readings.
FoundReadings EncoderArm::found(const kinematics::InverseSolution& solution) const {
  FoundReadings found{
      solution.verdict,
      calibration::encoder_readings(parts_.readings, parts_.configuration, solution.q),
      solution.rotation_error_rad, solution.regularity};
  if (is_solved(found.verdict) && !inside_limits(found.readings)) {
    found.verdict = kinematics::Verdict::kJointLimit;
  }
  return found;
}

Result<FoundReadings> EncoderArm::inverse(const Pose& X_BF, const JointVector& seed,
                                          const Vector3& p_FT) const {
  const JointVector turned =
      calibration::true_readings(parts_.readings, parts_.configuration, seed);
  ARMSIG_TRY(solution, kinematics::inverse(parts_.chain, last_frame(X_BF), turned, options(p_FT)));
  return found(solution);
}

Result<EncoderArm::All> EncoderArm::solutions(const Pose& X_BF, const JointVector& reference,
                                              const Vector3& p_FT) const {
  JointVector turned;
  if (!reference.empty()) {
    turned = calibration::true_readings(parts_.readings, parts_.configuration, reference);
  }
  ARMSIG_TRY(named,
             kinematics::cold_start(parts_.chain, form_, last_frame(X_BF), turned, options(p_FT)));
  All all;
  for (const kinematics::NamedSolution& one : named) all.push_back(found(one.solution));
  return all;
}

}  // namespace armsig::tool
