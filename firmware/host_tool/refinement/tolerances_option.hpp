// SPDX-License-Identifier: MIT
// The value of --tolerances: a factor, or a list of 1-sigma values with their units.
#pragma once

#include <string>

#include "firmware/formats/problem.hpp"
#include "hal/simulated/tolerances.hpp"

namespace armsig::tool {

// `1.5` multiplies the usual tolerances; `alpha_deg=0.1,a_mm=0.5` states some of them, the others
// are zero.
[[nodiscard]] Read<simulated::Tolerances> parse_tolerances(const std::string& text);

}  // namespace armsig::tool
