// SPDX-License-Identifier: MIT
// Poses of any joint that the features do not use: what they say of the arm that was found.
#pragma once

#include <optional>

#include "core/calibration/refined.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

struct UnusedPoses {
  std::size_t count = 0;
  double missed_m = 0;     // RMS, blunders cut down, the sensor's noise taken off
  double predicted_m = 0;  // RMS, by the covariance of the estimate
};

// How far the estimate misses the rows with sweep 0, and how far it says that it does. Nothing of
// fewer than a dozen rows of known targets.
[[nodiscard]] std::optional<UnusedPoses> judge_unused_poses(const Evidence& evidence,
                                                            const calibration::Refined& estimate);

}  // namespace armsig::tool
