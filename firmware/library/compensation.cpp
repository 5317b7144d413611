// SPDX-License-Identifier: MIT
#include "firmware/library/compensation.hpp"

#include "core/base/couplings.hpp"
#include "core/kinematics/forward.hpp"
#include "firmware/library/joint_frames.hpp"
#include "firmware/library/signature_chain.hpp"

namespace armsig::tool {
namespace {

using kinematics::Verdict;

EncoderArm nominal_arm(const Arm& nominal) {
  EncoderArm::Parts parts;
  parts.chain = kinematics::make_chain(nominal.joints, effective_limits(nominal));
  parts.readings.couplings = nominal.couplings;
  parts.configuration.resize(nominal.joints.size());
  parts.limits = nominal.limits;
  return EncoderArm(parts);
}

EncoderArm real_arm(const SignatureRecord& record, const Arm& nominal) {
  const Signature& signature = record.signature;
  EncoderArm::Parts parts;
  parts.chain = chain_of_record(record);
  parts.readings = record.readings();
  parts.configuration = signature.configuration;
  parts.limits = record.nominal.limits;
  const JointFrames frames = joint_frames(signature, nominal);
  parts.X_B0 = frames.X_SB.inverse() * signature.X_SL[0];
  const auto X_0n = kinematics::forward(parts.chain, signature.configuration);
  ARMSIG_CHECK(X_0n);  // a signature file holds finite numbers only
  parts.X_nF = (signature.X_SL[0] * *X_0n).inverse() * flange_in_sensor(frames, nominal);
  return EncoderArm(parts);
}

// Why the real arm does not get there.
Uncorrected why_not(const Result<FoundReadings>& found) {
  if (!found) return Uncorrected::kRealReach;
  if (is_solved(found->verdict)) return Uncorrected::kNone;
  return found->verdict == Verdict::kJointLimit ? Uncorrected::kJointLimit
                                                : Uncorrected::kRealReach;
}

}  // namespace

std::string_view describe(Uncorrected why) {
  switch (why) {
    case Uncorrected::kNone:
      return "corrected";
    case Uncorrected::kNominalReach:
      return "the nominal model does not reach it";
    case Uncorrected::kRealReach:
      return "the real arm does not reach it";
    case Uncorrected::kJointLimit:
      return "a joint limit is in the way";
    case Uncorrected::kConfiguration:
      return "the real arm reaches it in another configuration only";
    case Uncorrected::kTooLarge:
      return "the correction is larger than --most-mm allows";
  }
  return "not corrected";
}

Compensation::Compensation(const SignatureRecord& record, const Arm& nominal,
                           const CompensationOptions& options)
    : nominal_(nominal_arm(nominal)), real_(real_arm(record, nominal)), options_(options) {}

Result<Pose> Compensation::arrives(const JointVector& readings, const Pose& X_FT) const {
  ARMSIG_TRY(X_BF, real_.forward(readings));
  return X_BF * X_FT;
}

Correction Compensation::pose(const Pose& X_BF, const JointVector& at, const Pose& X_FT) const {
  Correction correction;
  correction.X_BF = X_BF;
  correction.nominal = at;
  correction.readings = at;
  const Pose X_BT = X_BF * X_FT;
  const auto without = arrives(at, X_FT);
  if (without) correction.missed_m = (without->p - X_BT.p).norm();
  const auto found = real_.inverse(X_BF, at, X_FT.p);
  correction.why = why_not(found);
  if (correction.why != Uncorrected::kNone) return correction;
  const auto told = nominal_.forward(found->readings);
  if (!told) {
    correction.why = Uncorrected::kRealReach;
    return correction;
  }
  correction.joint_change_rad = largest_change(at, found->readings);
  correction.moved_m = (*told * X_FT.p - X_BT.p).norm();
  correction.turned_rad = angle_between(told->R, X_BF.R);
  correction.singular = found->regularity < options_.singular_below;
  if (correction.joint_change_rad > options_.most_change_rad) {
    correction.why = Uncorrected::kConfiguration;
  } else if (!nominal_.inside_limits(found->readings)) {
    correction.why = Uncorrected::kJointLimit;
  } else if (correction.moved_m > options_.most_m) {
    correction.why = Uncorrected::kTooLarge;
  } else {
    correction.X_BF = *told;
    correction.readings = found->readings;
  }
  return correction;
}

Correction Compensation::joints(const JointVector& readings, const Pose& X_FT) const {
  const auto X_BF = nominal_.forward(readings);
  if (X_BF) return pose(*X_BF, readings, X_FT);
  Correction correction;
  correction.why = Uncorrected::kNominalReach;
  return correction;
}

}  // namespace armsig::tool
