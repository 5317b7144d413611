// SPDX-License-Identifier: MIT
// Column names of other software in ours.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "firmware/formats/measurements.hpp"

namespace armsig::tool {

// "X [mm]" -> x_mm, "A1 (°)" -> q1_deg, "Joint 2, rad" -> q2_rad, "Point" -> target, "T air [°C]"
// -> air_c. Nothing for a name or a unit that is not known, and where a joint's unit is not that of
// its type.
[[nodiscard]] std::optional<std::string> our_name_of(std::string_view theirs,
                                                     const JointTypes& types);

// "x_mm" -> "x": what a column of ours is about, whatever its unit.
[[nodiscard]] std::string_view quantity_of(std::string_view ours);

}  // namespace armsig::tool
