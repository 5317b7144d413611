// SPDX-License-Identifier: MIT
// What `armsig identify` says of a refinement.
#pragma once

#include <cstddef>

#include <nlohmann/json.hpp>

#include "firmware/host_tool/refinement/refinement_run.hpp"

namespace armsig::tool {

// `receivers`: how many the sensor has, 0 for one that gives positions.
void print_refinement(const RefinementOutcome& outcome, std::size_t receivers);
// Null: nothing was refined.
void print_models_tried(const RefinementOutcome* outcome);
[[nodiscard]] nlohmann::ordered_json refinement_json(const RefinementOutcome& outcome,
                                                     std::size_t receivers);

}  // namespace armsig::tool
