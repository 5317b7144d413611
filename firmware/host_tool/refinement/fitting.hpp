// SPDX-License-Identifier: MIT
// The engine of firmware/calibration over a log: its rows, its memory, and where it may start.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "firmware/host_tool/refinement/calibration_run.hpp"

namespace armsig::tool {

// Where a fit starts: a chain with the sensor, and the targets in its links.
struct FitStart {
  calibration::ArmModel model;
  std::vector<calibration::ModelTarget> targets;
  Signature signature;       // whose frames the result is put into
  bool of_the_rows = false;  // found from the same rows, not from the drawing
};

// The drawing `arm`, its base and targets as fitted.
[[nodiscard]] FitStart start_from_drawing(const CalibrationLog& log, const Arm& arm,
                                          const refinement::BaseAndTool& fitted);

// The signature that the features gave, as a chain: for drawings that lead nowhere. Precondition:
// the log has one.
[[nodiscard]] FitStart start_from_signature(const CalibrationLog& log);

// What poses left out say of a model.
struct LeftOut {
  calibration::HeldOutScore score;
  std::vector<float> length_m;  // of the error of every row of the log; 0 of those not left out
};

// The rows as the engine wants them, and its memory.
class Fitting {
 public:
  explicit Fitting(const CalibrationLog& log);

  // Fits from `start`, which becomes the result.
  [[nodiscard]] Result<calibration::FitSummary> run(FitStart& start,
                                                    const calibration::ModelParts& parts);

  // Of the model found by run(), from its start; destroys what the engine knows. None of too few
  // poses.
  [[nodiscard]] std::optional<LeftOut> score(FitStart start, const calibration::ModelParts& parts);

  // Notes in `model` between which readings the rows are that were not rejected.
  void note_covered(calibration::ArmModel& model) const;

  // Residuals and rejections, by the rows of the log.
  void report(std::span<refinement::RowOutcome> verdicts, refinement::FitQuality& quality) const;

  [[nodiscard]] const calibration::Engine& engine() const { return *engine_; }
  [[nodiscard]] double stated_variance() const { return stated_variance_; }

 private:
  std::vector<calibration::FitRow> rows_;
  std::vector<calibration::ChainFrames> cache_;
  std::vector<double> matrix_;
  std::unique_ptr<calibration::WorkspaceFor<kMaxJoints>> work_ =
      std::make_unique<calibration::WorkspaceFor<kMaxJoints>>();
  std::unique_ptr<calibration::Engine> engine_;
  double stated_variance_ = 0;
  std::size_t poses_ = 0;
};

}  // namespace armsig::tool
