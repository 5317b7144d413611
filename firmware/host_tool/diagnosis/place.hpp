// SPDX-License-Identifier: MIT
// From where an identified arm was measured: the rigid motion between what its signature predicts
// and what was seen.
#pragma once

#include <optional>
#include <span>

#include "core/calibration/refined.hpp"

namespace armsig::tool {

struct Place {
  Pose X_ON;           // takes points from the new sensor frame into that of the signature
  double shift_m = 0;  // at the middle of the points
  double turn_rad = 0;
  double before_m = 0;  // median length of the residuals as they are
  double after_m = 0;   // and with the motion undone
};

// Robust against gross outliers (Kabsch, reweighted). Nothing with fewer than four positions.
[[nodiscard]] std::optional<Place> fit_place(const calibration::Refined& estimate,
                                             std::span<const calibration::Observation> positions);

}  // namespace armsig::tool
