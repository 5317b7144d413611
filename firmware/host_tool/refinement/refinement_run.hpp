// SPDX-License-Identifier: MIT
// Maximum likelihood over everything measured: `armsig identify --method refined`.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/tool_accuracy.hpp"
#include "firmware/analysis/starts/start.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/host_tool/reading/measurement_log.hpp"
#include "firmware/host_tool/refinement/calibration_run.hpp"
#include "firmware/host_tool/signature/cross_validation.hpp"

namespace armsig::tool {

// What is to be found beside axes and targets.
struct FurtherUnknowns {
  calibration::ReadingTerms readings;  // of every joint
  bool choose_readings = false;        // those terms that predict rows left out better
  bool as_read = false;                // no terms, even where they are needed
  bool receiver_offsets = false;
  bool scale = false;
};

struct RefinementOutcome {
  std::unique_ptr<calibration::Refined> refined;      // too large for a stack
  calibration::ParameterRequest fitted;               // beside axes and targets
  std::vector<std::size_t> rejected_lines;            // gross outliers
  std::vector<std::size_t> outlying_lines;            // of them, those that validation confirms
  std::size_t free_poses_rejected = 0;                // rows with sweep 0 among them
  std::vector<std::string> undetermined;              // in words
  std::optional<CrossValidation> cross_validation;    // none of too few rows
  std::optional<calibration::HeldOutScore> left_out;  // the same, and what it says
  NoiseStatement noise;
  std::shared_ptr<const calibration::ArmModel> deflections;  // or none: geometry alone
  std::optional<double> geometry_left_out_mean_m;            // where there are deflections
  std::optional<OfferedCorrections> offered;
  std::optional<FoundCoupling> coupling;         // not part of `refined`
  std::vector<TriedModel> tried;                 // in that order
  calibration::HalfPlays half_plays;             // none where no play was found
  std::map<std::size_t, Vector3> moved_by_play;  // the target, by line of the file
  std::optional<std::size_t> merged_rows;        // of the fit, where neighbours were merged
  std::optional<double>
      nominal_rms_m;               // of the drawing with base and tool fitted; from drawings only
  std::vector<std::string> notes;  // in words: zeros and gears far from the drawing's
  // With a target on the last link only: over the joint limits; where gravity and maps were found,
  // over the readings that were measured, and apart over all that the limits allow.
  std::optional<ToolAccuracy::Predicted> predicted_tool_error;
  std::optional<double> predicted_over_limits_m;
};

// Refines from `start` where there is one, otherwise from the drawing with base and targets
// unknown. `log` is indexed by the targets of the start, or by its own.
[[nodiscard]] Read<RefinementOutcome> run_refinement(const Arm& nominal,
                                                     const std::optional<Signature>& start,
                                                     MeasurementLog& log,
                                                     const std::optional<SensorDescription>& sensor,
                                                     const FurtherUnknowns& further,
                                                     const std::string& file);

// What the outcome's own covariance predicts: its figures of the tool.
void predict_tool_error(const Arm& nominal, RefinementOutcome& outcome);

}  // namespace armsig::tool
