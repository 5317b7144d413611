// SPDX-License-Identifier: MIT
// Maximum likelihood over everything measured: `armsig identify --method refined`.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/refinement/cross_validation.hpp"
#include "core/refinement/start.hpp"
#include "firmware/host_tool/formats/problem.hpp"
#include "firmware/host_tool/measurement_log.hpp"

namespace armsig::tool {

struct RefinementOutcome {
  std::unique_ptr<refinement::Refined> refined;  // too large for a stack
  std::vector<std::size_t> rejected_lines;       // gross outliers
  std::vector<std::string> undetermined;         // in words
  refinement::CrossValidation cross_validation;
  std::optional<double>
      drawing_rms_m;  // of the drawing with base and tool fitted; from drawings only
  double predicted_tool_error_m = 0;
};

// Refines from `start` where there is one, otherwise from the drawing with base and targets
// unknown. `log` is indexed by the targets of the start, or by its own.
[[nodiscard]] Read<RefinementOutcome> run_refinement(const Arm& nominal,
                                                     const std::optional<Signature>& start,
                                                     MeasurementLog& log,
                                                     const std::optional<SensorDescription>& sensor,
                                                     const std::string& file);

// Covariance of the unknowns, in the order of the layout.
[[nodiscard]] Eigen::MatrixXd covariance_of(const refinement::Refined& refined);

// An estimate rebuilt from a signature and the covariance that came with it. Empty where they do
// not fit together.
[[nodiscard]] std::unique_ptr<refinement::Refined> estimate_from(const Signature& signature,
                                                                 const Arm& nominal,
                                                                 const Eigen::MatrixXd& covariance);

// Index of a target on the last link, whose position is what a tool error is about; nothing without
// one.
[[nodiscard]] std::optional<std::size_t> tool_target(const Signature& signature);

}  // namespace armsig::tool
