// SPDX-License-Identifier: MIT
// The engine of firmware/calibration over a log: its rows, its memory, and where it may start.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/calibration/half_play.hpp"
#include "firmware/analysis/evaluation/row_part.hpp"
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
  // Takes the rows of the log, but for a long one of which neighbours are merged
  // (merged_rows.hpp): its rows are to be gathered. `log` is kept as a reference.
  explicit Fitting(const CalibrationLog& log);

  // Gathers the rows of such a log, relative to the model of `start`; nothing of another one.
  void gather(const FitStart& start);

  // From now on the play of the joints is found too, by the order of the rows, or no longer.
  void find_play(bool wanted) { finds_play_ = wanted; }

  // The side of a joint in the rows before it first moved, where it is not known: bit j of `up`
  // set, its reading grew.
  void assume_first_sides(std::uint8_t up);

  // Fits from `start`, which becomes the result. Precondition: the rows were gathered.
  [[nodiscard]] Result<calibration::FitSummary> run(FitStart& start,
                                                    const calibration::ModelParts& parts);

  // Of the model found by run(), from its start; destroys what the engine and the play's block
  // know. None of too few poses.
  [[nodiscard]] std::optional<LeftOut> score(FitStart start, const calibration::ModelParts& parts);

  // Notes in `model` between which readings the rows are that were not rejected.
  void note_covered(calibration::ArmModel& model) const;

  // Residuals and rejections, by the rows of the log.
  void report(std::span<calibration::RowOutcome> verdicts, calibration::FitQuality& quality) const;

  // After run(), where play was to be found, otherwise empty: half of each joint's play, and what
  // it has moved the target of every row of the log by.
  [[nodiscard]] calibration::HalfPlays half_plays(std::size_t joints) const;
  [[nodiscard]] std::vector<Vector3> moved_by_play() const;
  [[nodiscard]] const calibration::PlayBlock& play() const { return play_; }

  [[nodiscard]] const std::vector<calibration::FitRow>& rows() const { return rows_; }
  // How many rows the fit has where neighbours were merged, or nothing.
  [[nodiscard]] std::optional<std::size_t> merged_rows() const {
    return parts_.empty() ? std::nullopt : std::optional(rows_.size());
  }
  [[nodiscard]] const calibration::Engine& engine() const { return *engine_; }
  [[nodiscard]] double stated_variance() const { return stated_variance_; }

 private:
  void group(std::vector<calibration::FitRow> rows);
  [[nodiscard]] bool score_folds(FitStart& start, const calibration::ModelParts& parts,
                                 std::span<calibration::RowScore> scores);
  [[nodiscard]] std::size_t measured() const;
  [[nodiscard]] bool is_rejected(std::size_t k) const;
  [[nodiscard]] Vector3 residual(std::size_t k) const;

  const CalibrationLog& log_;
  std::vector<calibration::FitRow> rows_;
  std::vector<calibration::RowPart> parts_;  // where rows were merged: of every row of the log
  std::vector<std::uint32_t> places_;        // in rows_, by FitRow::index
  std::vector<calibration::ChainFrames> cache_;
  std::vector<double> matrix_;
  std::unique_ptr<calibration::WorkspaceFor<kMaxJoints>> work_ =
      std::make_unique<calibration::WorkspaceFor<kMaxJoints>>();
  std::unique_ptr<calibration::Engine> engine_;
  calibration::PlayBlock play_;
  bool finds_play_ = false;
  std::uint8_t sided_ = 0;  // a bit a joint: the order of the rows shows its sides
  double stated_variance_ = 0;
  double gate_m_ = 0;  // of the last fit
  std::size_t poses_ = 0;
};

}  // namespace armsig::tool
