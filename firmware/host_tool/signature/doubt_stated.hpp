// SPDX-License-Identifier: MIT
// What a scale of the sensor that nobody knows does to the tool: the rows fit the arm that they
// make with it as well as the true one, so that nothing but the drawing tells.
#pragma once

#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

// RMS over the joint limits of what `factor` on all lengths does to the tool, base and tool fitted;
// 0 without a target on the last link.
[[nodiscard]] double moved_by_scale_m(const SignatureRecord& record, double factor);

// States in the record that the tool may be off by so much, as probably as `probability`, and says
// it in its last warning. Nothing where that is 0.
void state_scale(SignatureRecord& record, double factor, double probability);

}  // namespace armsig::tool
