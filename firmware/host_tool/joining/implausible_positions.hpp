// SPDX-License-Identifier: MIT
// Positions that no target on the arm can have: their unit is likely to be another.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/base/arm.hpp"
#include "firmware/formats/measurements.hpp"

namespace armsig::tool {

// In words: positions of one target that lie apart by twenty times the arm's reach, or that stay
// within a hundredth of what the drawing's flange moves by. A factor of a thousand, metres for
// millimetres, is beyond either; no target on a tool is.
[[nodiscard]] std::optional<std::string> implausible_positions(
    const Arm& nominal, std::span<const MeasurementRow> rows);

}  // namespace armsig::tool
