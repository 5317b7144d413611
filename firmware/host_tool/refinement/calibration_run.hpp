// SPDX-License-Identifier: MIT
// firmware/calibration over a log of positions or ranges: the memory it needs, the starts it may
// have, and what its figures mean for a signature.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/calibration/half_play.hpp"
#include "firmware/analysis/evaluation/held_out.hpp"
#include "firmware/analysis/starts/start.hpp"

namespace armsig::tool {

// Per axis, 1 sigma.
struct NoiseStatement {
  double total_m = 0;        // of a measured position about the model's prediction
  double stated_m = 0;       // rms of what the rows state; 0: nothing
  double unexplained_m = 0;  // what the sensor's own noise leaves of the total
  // What was stated is far more than the residuals show: it was not believed.
  bool contradicted = false;
};

// Corrections of the readings that were not asked for, and would help.
struct OfferedCorrections {
  calibration::ReadingTerms terms;
  double left_out_mean_m = 0;  // cross-validated, with them
};

// A coupling that the arm description lacks, or has with another ratio.
struct FoundCoupling {
  JointCoupling coupling;
  double sigma = 0;          // of its ratio
  double drawn_ratio = 0;    // 0: the description lacks it
  std::size_t rejected = 0;  // rows, with it
  std::size_t rejected_without = 0;
  double left_out_mean_m = 0;
  double left_out_mean_without_m = 0;
};

// A model that was fitted, and scored on poses left out.
struct TriedModel {
  calibration::ReadingTerms readings;  // found of every joint
  calibration::ModelParts parts;
  bool other_vertical = false;  // gravity does not pull as the arm description has it
  bool backlash = false;
  std::optional<JointCoupling> coupling;  // beside those of the description
  double left_out_mean_m = 0;
  std::size_t rejected = 0;  // rows
  bool written = false;      // it is the one
};

struct Calibrated {
  std::unique_ptr<calibration::Refined> refined;
  calibration::FitSummary summary;
  calibration::ParameterRequest request;  // corrections found
  std::optional<OfferedCorrections> offered;
  std::optional<calibration::HeldOutScore> left_out;  // none of too few poses
  std::vector<float> left_out_m;  // errors of every row of the log; 0 of those not left out
  std::optional<calibration::HeldOutScore> geometry;  // the same of geometry alone
  NoiseStatement noise;
  // Gravity and joint error maps, where poses left out are predicted better with them; the
  // readings of `refined` point there.
  std::shared_ptr<const calibration::ArmModel> deflections;
  std::optional<FoundCoupling> coupling;  // not part of `refined`
  std::vector<TriedModel> tried;          // in that order
  calibration::HalfPlays half_plays;      // none where no play was found
  std::vector<Vector3> moved_by_play;     // the target of every row of the log
  std::vector<std::size_t> alone;         // targets that a single row sees: nothing checks them
  std::optional<calibration::BaseAndTool> drawn;  // the drawing with base and targets fitted
  double nominal_rms_m = 0;                       // and what is left of its good rows
  std::optional<std::size_t> merged_rows;         // of the fit, where neighbours were merged
  JointVector zero_shifts;  // of the start, where the drawing's zeros led nowhere
};

struct CalibrationLog {
  const Arm& nominal;
  const std::optional<Signature>& start;  // from features, or none
  std::span<const calibration::Observation> rows;
  // What the base is found from: the rows, or where their ranges put the targets.
  std::span<const calibration::Observation> positions;
  std::span<const Target> targets;
  const calibration::Receivers& receivers;
  const calibration::ParameterRequest& request;  // corrections to be found
  bool choose_readings = false;                  // those of the readings that help
  bool as_read = false;                          // none, even where they are needed
};

// Fits the geometry, and gravity and joint error maps where they help, and scores the model on
// poses left out. `verdicts`, as long as the rows, receives residuals and rejections. Refusals:
// those of fit_base_and_tool(); kNotConverged and kTooManyOutliers where no arm near the
// description explains the rows; kScaleUndetermined; kCapacityExceeded (unknowns, capacity).
[[nodiscard]] std::expected<Calibrated, Refusal> run_calibration(
    const CalibrationLog& log, std::span<calibration::RowOutcome> verdicts);

}  // namespace armsig::tool
