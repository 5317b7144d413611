// SPDX-License-Identifier: MIT
// The method in reading order: from what the sweeps say about each joint to the arm signature.
//
//   core/measurement   ranges -> points
//   core/features      points -> one feature a joint: plane, centre, line      3.2.1, (13)-(14)
//   core/frames        features -> link frames                                 3.2.2, (15)-(17)
//   core/s_model       link frames -> S-Model by Paul's backward multiplication   3.2.3, (18)
//   core/pseudo_dh     S-Model -> pseudo-DH         3.2.4, (9)-(12), (19), (22)-(23)
//   core/kinematics    pseudo-DH -> poses, in servo                                 (1), (21)
//
// The first two run while the joints sweep, the last one in servo; identify() runs those between.
#pragma once

#include <cstddef>
#include <expected>
#include <optional>
#include <span>

#include "core/base/arm.hpp"
#include "core/base/error.hpp"
#include "core/frames/sense.hpp"
#include "core/signature.hpp"

namespace armsig {

// Why there is no signature, and at which joint (index from 0).
struct IdentificationFailure {
  Refusal refusal;
  std::size_t joint = 0;
  frames::SenseCheck sense;  // of kMirroredSense: every reversed joint, or the mirrored sensor
};

// The signature of the arm whose joint i gave features[i], swept in the signature configuration
// `configuration` (effective readings: couplings applied). The drawing decides between the two
// forms of each S-Model row (see s_model::Branch) and says which way the joints should turn; where
// its axes match in no way, the signature says so in description_matches and is valid none the
// less. The caller adds the targets.
//
// An arm with fewer than two revolute joints is never refused for its sense: the same flag tells.
//
// Errors: kNotFinite, a feature or reading is not a finite number, or an axis has no direction;
// kMirroredSense, with the greatest angle between drawn and identified axes found and allowed:
// joint is the first reversed one, and 0 where the sensor frame is mirrored. Preconditions: 1 to 8
// features, one reading and one row of the drawing for each, of the same type.
[[nodiscard]] std::expected<Signature, IdentificationFailure> identify(
    const FixedVector<features::JointFeature, kMaxJoints>& features,
    const JointVector& configuration, const Arm& drawing);

// identify(), a bounded step at a time, for those who have a tick to keep.
class Identification {
 public:
  // `signature` has the features and the configuration, and gets the rest. Both must outlive it.
  Identification(Signature& signature, const Arm& drawing);

  // False if the signature is whole. After an error it is not to be called again.
  [[nodiscard]] std::expected<bool, IdentificationFailure> step();

 private:
  [[nodiscard]] std::expected<void, IdentificationFailure> place_frames();
  [[nodiscard]] std::expected<void, IdentificationFailure> judge_sense();

  Signature& signature_;
  const Arm& drawing_;
  std::optional<frames::SenseChecking> sense_;  // empty until the frames are placed
};

// S-Model and pseudo Denavit-Hartenberg parameters from the link frames X_SL, which stay as they
// are. Also for a signature whose frames a refinement has changed. `branch` is the drawing, or any
// arm of as many joints: it decides only between equal forms.
void derive_parameters(Signature& signature, const Arm& branch);

// A target of an arm that is known: fixed to link `link` (0 = the base), in Denavit-Hartenberg
// frame `link` of the arm.
struct KnownTarget {
  int number = 0;
  std::size_t link = 0;
  Vector3 p_F = Vector3::Zero();
};

// The exact signature of a known arm that stands with its base at X_S0: the truth of a simulation.
// Link frame 0 is the base, link frame n the arm's Denavit-Hartenberg frame n; those between stand
// near the arm, so that predictions keep 1e-13 m where d is hundreds of metres.
// Preconditions: 1 to 8 joints, one reading each, at most kMaxTargets targets on links of the arm.
[[nodiscard]] Signature signature_of(const Arm& arm, const JointVector& configuration,
                                     const Pose& X_S0, std::span<const KnownTarget> targets);

}  // namespace armsig
