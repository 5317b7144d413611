// SPDX-License-Identifier: MIT
// By what an arm is not the one of its drawing, in words.
#pragma once

#include <string>

#include "firmware/host_tool/diagnosis/near_fit.hpp"

namespace armsig::tool {

// The deviation that is largest against what `limits` allow: "the axis after joint 2 is tilted by
// 3.10° from the drawing's, 2.00° are allowed".
[[nodiscard]] std::string deviation_in_words(const NearFit& fit, const ArmLimits& limits,
                                             const Arm& arm);

}  // namespace armsig::tool
