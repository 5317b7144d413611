// SPDX-License-Identifier: MIT
// What a scale of the sensor that nobody knows does to the tool: the rows fit the arm that they
// make with it as well as the true one, so that nothing but the drawing tells.
#pragma once

#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/diagnosis/gate.hpp"

namespace armsig::tool {

// RMS over the joint limits of what `factor` on all lengths does to the tool, base and tool fitted;
// 0 without a target on the last link.
[[nodiscard]] double moved_by_scale_m(const SignatureRecord& record, double factor);

// A slide that goes farther than it reads, or less: the reading may err, or the sensor by a scale.
[[nodiscard]] std::optional<Doubt> doubt_of_slide(const Signature& signature);

// States in the record what the tool may be off by if its last warning, `doubt`, is right, as
// probably as it is, and says so there; that much, RMS. Nothing where that has no probability.
double state_doubt(SignatureRecord& record, const Doubt& doubt);

}  // namespace armsig::tool
