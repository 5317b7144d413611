// SPDX-License-Identifier: MIT
// What a closed controller must be told so that the real arm arrives: the controller computes with
// its nominal model, so that the corrected target is FK_nominal(IK_real(target)).
//
// The base frame B is that of the nominal model, laid over the real axes (joint_frames.hpp); the
// flange F is the nominal model's last frame, carried by the real last link. Nothing here
// allocates.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/formats/signature_record.hpp"
#include "firmware/library/encoder_arm.hpp"

namespace armsig::tool {

enum class Uncorrected : std::uint8_t {
  kNone,           // it is corrected
  kNominalReach,   // the nominal model does not reach the target
  kRealReach,      // the real arm does not
  kJointLimit,     // the real arm would have to leave its joint limits
  kConfiguration,  // a joint would move by more than the same configuration explains
  kTooLarge,       // the correction is larger than allowed
};
// A phrase to follow "line 12: ", without a full stop.
[[nodiscard]] std::string_view describe(Uncorrected why);

struct Correction {
  Uncorrected why = Uncorrected::kNone;
  Pose X_BF;                    // to be told, in place of the target
  JointVector nominal;          // where the controller would go, told the target
  JointVector readings;         // where the arm must go; the controller goes there, told X_BF
  double moved_m = 0;           // the correction at the tool
  double turned_rad = 0;        // the same, of its orientation
  double missed_m = 0;          // by how much the tool misses the target without the correction
  double joint_change_rad = 0;  // the largest, from `nominal` to `readings`
  bool singular = false;        // near a singularity: small corrections may be large joint motions
};

struct CompensationOptions {
  double most_m = 0.02;           // no larger correction at the tool
  double most_change_rad = 0.35;  // of a joint in the same configuration
  double singular_below = 0.01;   // regularity
};

class Compensation {
 public:
  // `nominal`: the model that the closed controller computes with; its joints are of the types of
  // the record's. The record outlives this.
  Compensation(const SignatureRecord& record, const Arm& nominal,
               const CompensationOptions& options = {});

  [[nodiscard]] const EncoderArm& nominal() const { return nominal_; }
  [[nodiscard]] const EncoderArm& real() const { return real_; }

  // The pose X_BF of the flange, which the controller reaches at readings `at`. X_FT: the tool.
  [[nodiscard]] Correction pose(const Pose& X_BF, const JointVector& at, const Pose& X_FT) const;

  // Joint readings, which are replaced by those that bring the real arm to where the nominal model
  // has it.
  [[nodiscard]] Correction joints(const JointVector& readings, const Pose& X_FT) const;

  // Where the tool of the real arm is when the controller goes to `readings`.
  [[nodiscard]] Result<Pose> arrives(const JointVector& readings, const Pose& X_FT) const;

 private:
  EncoderArm nominal_;
  EncoderArm real_;
  CompensationOptions options_;
};

}  // namespace armsig::tool
