// SPDX-License-Identifier: MIT
// Touches of places to an arm: starts from nothing, mistakes, the model that the touches support,
// what is known then (docs/model.md, section 13).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/formats/problem.hpp"
#include "firmware/host_tool/places/place_accuracy.hpp"
#include "firmware/host_tool/places/place_mistakes.hpp"
#include "firmware/host_tool/places/place_validation.hpp"
#include "firmware/host_tool/refinement/refinement_run.hpp"

namespace armsig::tool {

struct PlaceCalibration {
  std::unique_ptr<PlaceTask> task;  // with the lengths that are believed
  std::unique_ptr<PlaceFit> fit;
  std::vector<SocketLength> known;         // all lengths of the file whose ends were touched
  std::vector<PredictedLength> predicted;  // of these
  std::vector<RejectedTouch> rejected;
  std::optional<PlacementValidation> validation;
  Determined determined;
  ToolKnowledge knowledge;  // over the region of the outcome's predicted tool error
  std::vector<std::string> warnings;
  RefinementOutcome outcome;  // for the signature
};

// The fit with geometry, gravity and maps, without maps, or with geometry alone where the evidence
// is against the rest; the lengths are those of `task`.
[[nodiscard]] std::unique_ptr<PlaceFit> fit_places(const PlaceTask& task);

// That with geometry and gravity, from nothing: fit_places() goes on from it.
[[nodiscard]] std::unique_ptr<PlaceFit> fit_without_maps(const PlaceTask& task);

// `file` names the touches in problems. Refuses touches that are too few, that fit no places, known
// lengths that contradict each other, and an arm that is not like its nominal model.
[[nodiscard]] Read<PlaceCalibration> calibrate_by_places(PlaceTask task, const std::string& file);

}  // namespace armsig::tool
