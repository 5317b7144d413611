// SPDX-License-Identifier: MIT
#include "core/identification.hpp"

#include <algorithm>
#include <cmath>

#include "core/frames/axis_lines.hpp"
#include "core/frames/link_frames.hpp"
#include "core/pseudo_dh/pseudo_dh.hpp"
#include "core/s_model/s_model.hpp"

namespace armsig {
namespace {

bool is_usable(const features::JointFeature& feature, double reading) {
  return feature.axis_S.allFinite() && feature.axis_S.norm() > 0 && feature.point_S.allFinite() &&
         feature.radial_S.allFinite() && std::isfinite(feature.reference_reading) &&
         std::isfinite(reading);
}

// Slides and a single turn: which way round such a stage is drawn is a matter of naming its
// directions, and drawings of stages are careless about it. From two turns on, a reversed one makes
// another arm.
bool drawing_binds_the_sense(const JointTypes& types) {
  return std::ranges::count(types, JointType::kRevolute) >= 2;
}

}  // namespace

std::expected<Signature, IdentificationFailure> identify(
    const FixedVector<features::JointFeature, kMaxJoints>& features,
    const JointVector& configuration, const Arm& drawing) {
  std::expected<Signature, IdentificationFailure> identified;
  identified->features = features;
  identified->configuration = configuration;
  Identification identification(*identified, drawing);
  for (;;) {
    const auto more = identification.step();
    if (!more) return std::unexpected(more.error());
    if (!*more) return identified;
  }
}

Identification::Identification(Signature& signature, const Arm& drawing)
    : signature_(signature), drawing_(drawing) {
  const std::size_t n = signature.features.size();
  ARMSIG_CHECK(n > 0 && signature.configuration.size() == n && drawing.joints.size() == n);
}

std::expected<bool, IdentificationFailure> Identification::step() {
  if (!sense_) {
    if (auto placed = place_frames(); !placed) return std::unexpected(placed.error());
    sense_.emplace(drawing_, signature_.configuration, frames::axis_lines(signature_));
    return true;
  }
  if (sense_->step()) return true;
  if (auto judged = judge_sense(); !judged) return std::unexpected(judged.error());
  derive_parameters(signature_, drawing_);
  return false;
}

std::expected<void, IdentificationFailure> Identification::place_frames() {
  signature_.types.clear();
  for (std::size_t i = 0; i < signature_.features.size(); ++i) {
    const features::JointFeature& feature = signature_.features[i];
    ARMSIG_CHECK(feature.type == drawing_.joints[i].type);
    if (!is_usable(feature, signature_.configuration[i])) {
      return std::unexpected(IdentificationFailure{{Error::kNotFinite}, i, {}});
    }
    signature_.types.push_back(feature.type);
  }
  signature_.X_SL = frames::link_frames(signature_.features, signature_.configuration);
  return {};
}

std::expected<void, IdentificationFailure> Identification::judge_sense() {
  const frames::SenseCheck& sense = sense_->result();
  const bool turned_over = sense.verdict == frames::SenseVerdict::kJointsReversed ||
                           sense.verdict == frames::SenseVerdict::kSensorMirrored;
  if (turned_over && drawing_binds_the_sense(signature_.types)) {
    const auto* first = std::ranges::find(sense.reversed, true);
    const std::size_t joint = first == sense.reversed.end() ? 0 : first - sense.reversed.begin();
    const Refusal refusal{Error::kMirroredSense, sense.angle_rad, frames::kMatchAngleRad};
    return std::unexpected(IdentificationFailure{refusal, joint, sense});
  }
  signature_.description_matches = sense.verdict == frames::SenseVerdict::kAgrees;
  return {};
}

void derive_parameters(Signature& signature, const Arm& branch) {
  const std::size_t n = signature.joint_count();
  ARMSIG_CHECK(branch.joints.size() == n && signature.X_SL.size() == n + 1);
  signature.s_model.clear();
  Pose X_S_before = signature.X_SL[0];
  for (std::size_t i = 0; i < n; ++i) {
    const Pose& X_S_here = signature.X_SL[i + 1];
    const Pose B = X_S_before.inverse() * X_S_here;  // (18)
    const s_model::Parameters s = s_model::from_transform(B, s_model::branch_of(branch.joints[i]));
    signature.s_model.push_back(s);
    // Axes that were made parallel have turned the frame by that little; the next row takes it from
    // there, so that the chain still ends where it should.
    X_S_before = s_model::is_parallel(s) ? X_S_before * s_model::to_transform(s) : X_S_here;
  }
  signature.pseudo_dh =
      pseudo_dh::from_s_model(signature.s_model, signature.types, signature.configuration);
}

Signature signature_of(const Arm& arm, const JointVector& configuration, const Pose& X_S0,
                       std::span<const KnownTarget> targets) {
  const frames::KnownLinkFrames known = frames::link_frames(arm.joints, configuration);
  Signature signature;
  signature.types = types_of(arm.joints);
  signature.configuration = configuration;
  for (const Pose& X_0L : known.X_0L) signature.X_SL.push_back(X_S0 * X_0L);
  for (const KnownTarget& target : targets) {
    const Vector3 p_L = target.p_F - Vector3(0, 0, known.along_m[target.link]);
    signature.targets.push_back(
        {target.number, target.link, signature.X_SL[target.link] * p_L, Matrix3::Zero()});
  }
  derive_parameters(signature, arm);
  return signature;
}

}  // namespace armsig
