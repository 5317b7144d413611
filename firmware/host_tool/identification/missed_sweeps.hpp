// SPDX-License-Identifier: MIT
// Sweeps whose points the arm found by features misses as a whole. Each feature follows its own
// sweep, whatever the others say: a sensor that was moved between two of them, or a reading that
// errs, is seen by the arm that they make together, and by none of them alone.
#pragma once

#include <optional>

#include "core/calibration/refined.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

struct MissedSweeps {
  double missed_m = 0;     // RMS over the sweeps, the sensor's noise taken off, blunders left out
  double predicted_m = 0;  // RMS, by the covariance of the estimate
};

// How far the estimate misses the rows of the sweeps, and how far it says that it does: each sweep
// of each target counts as one. Nothing without a sweep of eight rows of a known target.
[[nodiscard]] std::optional<MissedSweeps> judge_missed_sweeps(const Evidence& evidence,
                                                              const calibration::Refined& estimate);

}  // namespace armsig::tool
