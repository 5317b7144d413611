// SPDX-License-Identifier: MIT
// The arms of Stone, Sanderson and Neuman 1986: the drawing of the Puma 560 and the two robots they
// identified.
#pragma once

#include <array>

#include "core/base/arm.hpp"

namespace armsig::tool {

// Table 1: ideal kinematic parameters. Limits of the Puma Mark II 500 series.
[[nodiscard]] Arm puma560();

// Table 2, robot 1 or 2: identified pseudo Denavit-Hartenberg parameters, taken as an exact arm.
[[nodiscard]] Arm table2_robot(int robot);

// Table 3, robot 1 or 2: improvement factors, in the order normal, perpendicular, radial,
// orientation. The table's heading names the ratio the other way round; as numbers they are
// performance without over with the signature.
[[nodiscard]] std::array<double, 4> table3(int robot);

}  // namespace armsig::tool
