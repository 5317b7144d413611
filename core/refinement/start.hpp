// SPDX-License-Identifier: MIT
// Refinement without sweeps: from the drawing of the arm, its base and targets unknown.
#pragma once

#include "core/refinement/base_and_tool.hpp"
#include "core/refinement/refinement.hpp"

namespace armsig::refinement {

// What was found on the way from a drawing.
struct DrawingReport {
  double drawn_rms_m = 0;  // of the drawing as it is, base and targets fitted
  JointVector
      zero_shifts;  // of the joints' zeros, where the drawing's led nowhere; empty otherwise
};

// What a drawing can be wrong by, and a fit be left with, and still be believed.
struct StartLimits {
  double drawn_rms_m = 0.5;         // residual lengths with base and targets fitted only
  double rms_m = 5e-3;              // residual lengths of the refined arm
  double twist_rad = radians(10);   // change of the angle between two neighbouring axes
  double turned_rad = radians(60);  // between any two, at the readings of drawn_signature()
};

// Refuses (kNotConverged: angle found, allowed [rad]) what no arm made to its drawing would give:
// the angle between two axes that has changed too much.
[[nodiscard]] std::expected<void, Refusal> like_its_drawing(const Signature& drawn,
                                                            const Signature& found,
                                                            const StartLimits& limits);

// The signature that the drawing predicts: base and targets as fitted, at the readings of the row
// that lies most in the middle of the log.
[[nodiscard]] Signature drawn_signature(const Arm& arm, const BaseAndTool& fitted,
                                        std::span<const Observation> log,
                                        std::span<const Target> targets);

// fit_base_and_tool(), then refine() from there; where that leads to no arm like its drawing,
// fit_zeros() first. The couplings are those of `arm`. `report` may be null. `positions` are what
// the base is found from where the log holds ranges instead (targets by the same index); none: the
// log. A minimum that is not the true one leaves residuals far above any sensor, or needs an arm
// unlike its drawing: either is refused as kNotConverged (found and allowed RMS [m], or deviation),
// never returned. Errors: those of both.
[[nodiscard]] std::expected<void, Refusal> refine_from_drawing(
    const Arm& arm, std::span<const Observation> log, std::span<const Target> targets,
    const RefinementConfig& config, std::span<RowOutcome> outcomes, Refined& refined,
    const StartLimits& limits = {}, DrawingReport* report = nullptr,
    std::span<const Observation> positions = {});

}  // namespace armsig::refinement
