// SPDX-License-Identifier: MIT
// Why a drawing does not explain a log: a reading that does not move its joint as the drawing says.
#pragma once

#include <optional>
#include <span>

#include "firmware/analysis/starts/base_and_tool.hpp"

namespace armsig::calibration {

struct ReadingSuspicion {
  // What the drawing should say. A joint coupled to itself by -2 turns against its reading; a ratio
  // of 0 is a coupling that the arm does not have.
  JointCoupling coupling;
  double plain_rms_m = 0;  // of the drawing as it is, base and tool fitted
  double rms_m = 0;        // with that coupling

  [[nodiscard]] bool reversed() const { return coupling.joint == coupling.from; }
};

// Tries every pair of an earlier and a later joint of one type with ratios -1, 0 and 1, and every
// joint reversed, of those that moved; then whether another ratio of the best is better still.
// Nothing where none of them explains the log far better than the drawing as it is. Preconditions:
// those of fit_base_and_tool().
[[nodiscard]] std::optional<ReadingSuspicion> suspect_readings(const Arm& arm,
                                                               std::span<const Observation> log,
                                                               std::span<const Target> targets);

}  // namespace armsig::calibration
