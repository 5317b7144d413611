// SPDX-License-Identifier: MIT
// The engine of firmware/calibration over a log: its rows, its memory, and where it may start.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/calibration/half_play.hpp"
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
                                          const calibration::BaseAndTool& fitted);

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

  // From now on the play of the joints is found too, by the order of the rows, or no longer.
  void find_play(bool wanted) { finds_play_ = wanted; }

  // The side of a joint in the rows before it first moved, where it is not known: bit j of `up`
  // set, its reading grew.
  void assume_first_sides(std::uint8_t up);

  // Fits from `start`, which becomes the result.
  [[nodiscard]] Result<calibration::FitSummary> run(FitStart& start,
                                                    const calibration::ModelParts& parts);

  // Of the model found by run(), from its start; destroys what the engine and the play's block
  // know. None of too few poses.
  [[nodiscard]] std::optional<LeftOut> score(FitStart start, const calibration::ModelParts& parts);

  // Notes in `model` between which readings the rows are that were not rejected.
  void note_covered(calibration::ArmModel& model) const;

  // Residuals and rejections, by the rows of the log.
  void report(std::span<calibration::RowOutcome> verdicts, calibration::FitQuality& quality) const;

  // After run(): half of each joint's play, none where it was not found; and what it has moved the
  // target of every row of the log by.
  [[nodiscard]] calibration::HalfPlays half_plays(std::size_t joints) const;
  [[nodiscard]] std::vector<Vector3> moved_by_play() const;
  [[nodiscard]] const calibration::PlayBlock& play() const { return play_; }

  [[nodiscard]] const std::vector<calibration::FitRow>& rows() const { return rows_; }
  [[nodiscard]] const calibration::Engine& engine() const { return *engine_; }
  [[nodiscard]] double stated_variance() const { return stated_variance_; }

 private:
  std::vector<calibration::FitRow> rows_;
  std::vector<calibration::ChainFrames> cache_;
  std::vector<double> matrix_;
  std::unique_ptr<calibration::WorkspaceFor<kMaxJoints>> work_ =
      std::make_unique<calibration::WorkspaceFor<kMaxJoints>>();
  std::unique_ptr<calibration::Engine> engine_;
  calibration::PlayBlock play_;
  bool finds_play_ = false;
  std::uint8_t sided_ = 0;  // a bit a joint: the order of the rows shows its sides
  double stated_variance_ = 0;
  std::size_t poses_ = 0;
};

}  // namespace armsig::tool
