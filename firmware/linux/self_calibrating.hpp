// SPDX-License-Identifier: MIT
// What armsigd refines with: there is memory enough on embedded Linux.
#pragma once

#include "firmware/self_calibration/self_calibration.hpp"

namespace armsig::daemon {

// Points that are kept of an identification: 2.2 MB.
inline constexpr std::size_t kSelfCalibrationPoints = 1200;

// Large: keep it out of stacks.
struct SelfCalibrating {
  // Outlived by `configuration`.
  explicit SelfCalibrating(const controller::Configuration& configuration)
      : calibration(configuration, memory) {}

  controller::SelfCalibrationMemory<kSelfCalibrationPoints> memory;
  controller::SelfCalibration calibration;
};

}  // namespace armsig::daemon
