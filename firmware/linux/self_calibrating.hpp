// SPDX-License-Identifier: MIT
// What armsigd refines with: there is memory enough on embedded Linux, and a file beside the
// signatures for what was measured.
#pragma once

#include <optional>

#include "firmware/linux/daemon_configuration.hpp"
#include "firmware/self_calibration/self_calibration.hpp"
#include "hal/linux/file_memory.hpp"

namespace armsig::daemon {

// Points that are kept of an identification: 2.2 MB.
inline constexpr std::size_t kSelfCalibrationPoints = 1200;

// Large: keep it out of stacks.
class SelfCalibrating {
 public:
  // Outlived by `configuration`. The file is that of the signatures with `.points` behind its name;
  // where there can be none it is told on standard error, and nothing is kept across restarts.
  explicit SelfCalibrating(const DaemonConfiguration& configuration);
  SelfCalibrating(const SelfCalibrating&) = delete;
  SelfCalibrating& operator=(const SelfCalibrating&) = delete;

  [[nodiscard]] controller::Refinement& refinement() { return calibration_; }

 private:
  std::optional<linux_hal::FileMemory> file_;
  std::optional<controller::PointJournal> journal_;
  controller::SelfCalibrationMemory<kSelfCalibrationPoints> memory_;
  controller::SelfCalibration calibration_;
};

}  // namespace armsig::daemon
