// SPDX-License-Identifier: MIT
// A drawing whose joint zeros are not those of the encoders: the zeros are found with base and
// tool.
#pragma once

#include <span>

#include "firmware/analysis/starts/base_and_tool.hpp"

namespace armsig::calibration {

struct ZeroedDrawing {
  Arm arm;             // the drawing with the zeros found
  JointVector shifts;  // by which they differ from the drawing's, within half a turn
  BaseAndTool fitted;  // of that arm
};

// Levenberg-Marquardt on base, target and zeros, from the zeros drawn; where that leaves more than
// lengths drawn wrong by centimetres would, from single zeros a quarter, half or three quarters of
// a turn away as well, the best of them kept, up to three joints. Preconditions and errors: those
// of fit_base_and_tool().
[[nodiscard]] Judged<ZeroedDrawing> fit_zeros(const Arm& arm, std::span<const Observation> log,
                                              std::span<const Target> targets);

}  // namespace armsig::calibration
