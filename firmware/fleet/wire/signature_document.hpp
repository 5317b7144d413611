// SPDX-License-Identifier: MIT
// The document of a signature in the record of a plant: one line of text, whose SHA-256 names it.
//
//   theta1_deg=0.010000 d1_mm=0.0000 a1_mm=0.0000 alpha1_deg=-90.000000 theta2_deg=... ...
//   type3=prismatic
//   zero2_rad=0 rest2_rad=0.5 map2_from_rad=-3.1 map2_knots_per_rad=19.1 map2_step_rad=1e-8
//   map2=0,12,-3,... gravity=1,2,1.5e-05 gravity=...
//
// all separated by one space: the rows as `signature` of the console tells them; which joints are
// prismatic, where any is; of a signature that has them the zero of each joint in the drawing, the
// reading at which it stands as the reading says, the map of its reading at its 120 knots, in
// steps, which way is up in frame 0, where that is not z, and deflection by gravity: joint, link
// origin, rad (m) per m of lever. A signature that has none of these is its rows alone. Documents
// of former versions have no `rest`.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/base/arm.hpp"
#include "core/calibration/packed_deflections.hpp"

namespace armsig::fleet {

// A nominal arm for calibration::check() where its lengths are not known: shorter than any. At
// least one joint.
[[nodiscard]] Arm of_unknown_lengths(std::size_t joints);

// `rows` and what the joints' types and deflections add to them. `configuration`: that of the
// signature, effective readings, as many as types; or none, and nothing is told of it.
[[nodiscard]] std::string signature_document(std::string_view rows,
                                             std::span<const JointType> types,
                                             const calibration::PackedDeflections& deflections,
                                             std::span<const double> configuration);

struct DocumentedSignature {
  Arm arm;  // every revolute joint with a whole turn, every slide with a metre: they are not told
  calibration::PackedDeflections deflections;
  JointVector configuration;  // none where it does not bend, or where that was not told
};

// None: it is no such document, or says what no arm has.
[[nodiscard]] std::optional<DocumentedSignature> read_signature_document(std::string_view document);

}  // namespace armsig::fleet
