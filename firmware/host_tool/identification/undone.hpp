// SPDX-License-Identifier: MIT
// Rows as the sensor would have seen them without what was found of its own errors.
#pragma once

#include <optional>

#include "firmware/formats/sensor_file.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"
#include "firmware/host_tool/refinement/refinement_run.hpp"

namespace armsig::tool {

// Offsets of the ranges and a scale that were asked for are undone, and backlash that was found, so
// that the rest can be judged. A rejected free pose to which a joint with backlash came from an
// unknown side is left out: nobody knows by how much the backlash moved it.
[[nodiscard]] Evidence undone(const Evidence& evidence, const RefinementOutcome& outcome,
                              const std::optional<SensorDescription>& sensor);

}  // namespace armsig::tool
