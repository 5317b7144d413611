// SPDX-License-Identifier: MIT
// The work of the calibration rows: the geometry of a Puma made to the usual tolerances, of 39
// unknowns with its base and target, from positions measured to 0.2 mm.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/calibration/engine.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::benchmarks {

struct CalibrationLog {
  std::string path;
  int points_per_sweep;  // of each of six sweeps; 0: none
  int mixed_rows;
};
inline const std::array<CalibrationLog, 3> kCalibrationLogs = {
    {{"calibration, 39 unknowns, 6 x 36 points", 36, 0},
     {"calibration, 39 unknowns, 216 swept and 34 mixed rows", 36, 34},
     {"calibration, 39 unknowns, 250 mixed rows", 0, 250}}};

// A fit that can be done again from its start: the drawing, with base and target fitted.
class CalibrationWork {
 public:
  explicit CalibrationWork(const CalibrationLog& of);

  // Aborts where it is refused.
  void fit();

  [[nodiscard]] const calibration::ArmModel& start() const { return *start_; }
  [[nodiscard]] const calibration::ArmModel& found() const { return *model_; }
  [[nodiscard]] const Vector3& start_p_L() const { return start_p_L_; }
  [[nodiscard]] const calibration::ModelTarget& target() const { return targets_[0]; }
  [[nodiscard]] const calibration::Scales& scales() const { return scales_; }
  [[nodiscard]] const test::Log& log() const { return log_; }

 private:
  test::Log log_;
  Vector3 start_p_L_;
  std::unique_ptr<calibration::ArmModel> start_ = std::make_unique<calibration::ArmModel>();
  std::unique_ptr<calibration::ArmModel> model_ = std::make_unique<calibration::ArmModel>();
  std::array<calibration::ModelTarget, 1> targets_{};
  std::vector<calibration::FitRow> rows_;
  std::vector<calibration::ChainFrames> cache_;
  std::vector<double> matrix_;
  std::unique_ptr<calibration::WorkspaceFor<kMaxJoints>> work_ =
      std::make_unique<calibration::WorkspaceFor<kMaxJoints>>();
  calibration::Scales scales_;
};

}  // namespace armsig::benchmarks
