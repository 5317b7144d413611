// SPDX-License-Identifier: MIT
// Starts from the drawing of an arm, its base and targets as fitted; and what is still like it.
#pragma once

#include "core/calibration/refined.hpp"
#include "firmware/analysis/starts/base_and_tool.hpp"

namespace armsig::calibration {

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

}  // namespace armsig::calibration
