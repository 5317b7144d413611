// SPDX-License-Identifier: MIT
// Forward and inverse kinematics of an arm from what its encoders read: couplings, corrections,
// gravity and joint error maps are applied on the way. Nothing here allocates.
#pragma once

#include "core/calibration/readings.hpp"
#include "firmware/analysis/postures/cold_start.hpp"

namespace armsig::tool {

// Encoder readings that bring the flange to a pose, or come near it.
struct FoundReadings {
  kinematics::Verdict verdict = kinematics::Verdict::kOutOfReach;
  JointVector readings;
  double rotation_error_rad = 0;
  double regularity = 0;  // core/kinematics/regularity.hpp
};

[[nodiscard]] inline bool is_solved(kinematics::Verdict verdict) {
  return verdict == kinematics::Verdict::kConverged || verdict == kinematics::Verdict::kDegraded;
}

class EncoderArm {
 public:
  struct Parts {
    kinematics::Chain chain;
    calibration::ReadingModel readings;  // what it points to outlives the arm
    JointVector configuration;           // effective readings at which the chain is as it says
    FixedVector<JointLimits, kMaxJoints> limits;  // of the encoder readings
    Pose X_B0;                                    // frame 0 of the chain in the base frame
    Pose X_nF;                                    // the flange in frame n of the chain
  };
  explicit EncoderArm(const Parts& parts);

  [[nodiscard]] std::size_t joint_count() const { return parts_.chain.joint_count; }

  // The flange in the base frame. Errors: kNotFinite.
  [[nodiscard]] Result<Pose> forward(const JointVector& readings) const;

  // The readings near `seed` that bring the flange to X_BF. `p_FT`: the point of the flange whose
  // position counts where an arm of fewer than six joints meets no whole pose. Readings beyond
  // their limits are kJointLimit. Errors: those of kinematics::inverse().
  [[nodiscard]] Result<FoundReadings> inverse(const Pose& X_BF, const JointVector& seed,
                                              const Vector3& p_FT = Vector3::Zero()) const;

  // All readings that do, those inside the limits first, those nearest to `reference` first (empty:
  // the middle of the limits), as kinematics::cold_start() finds them. Revolute joints are turned
  // into their limits by whole turns where they can be. Errors: those of cold_start().
  using All = FixedVector<FoundReadings, kinematics::kMaxSolutions>;
  [[nodiscard]] Result<All> solutions(const Pose& X_BF, const JointVector& reference = {},
                                      const Vector3& p_FT = Vector3::Zero()) const;

  // Limits are met exactly but for rounding.
  [[nodiscard]] bool inside_limits(const JointVector& readings) const;

 private:
  [[nodiscard]] Pose last_frame(const Pose& X_BF) const;
  [[nodiscard]] kinematics::InverseOptions options(const Vector3& p_FT) const;
  [[nodiscard]] FoundReadings judged(const kinematics::InverseSolution& solution, const Pose& X_0n,
                                     const kinematics::InverseOptions& options) const;
  [[nodiscard]] FoundReadings found(const kinematics::InverseSolution& solution, const Pose& X_0n,
                                    const kinematics::InverseOptions& options) const;
  [[nodiscard]] JointVector deflections_at(const JointVector& readings) const;
  [[nodiscard]] JointVector readings_of(JointVector turned) const;
  [[nodiscard]] double whole_turns_inside(std::size_t joint, double reading) const;
  [[nodiscard]] double beyond_limits(const JointVector& readings) const;
  [[nodiscard]] double most_deflection() const;

  Parts parts_;
  // With limits beyond those of the encoders by what the joints deflect: no solution is left out
  // that the encoders allow.
  kinematics::Chain wide_;
  kinematics::ClosedForm form_;
  Pose X_0B_;
  Pose X_Fn_;
};

}  // namespace armsig::tool
