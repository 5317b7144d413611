// SPDX-License-Identifier: MIT
// How far a model puts the tool from where the arm puts it, over the whole joint space.
#pragma once

#include "core/base/arm.hpp"
#include "core/signature.hpp"

namespace armsig::evaluation {

// Root mean square of |X_AM p_M(q) - p_A(q)| over `count` configurations spread evenly within
// `limits`: p_M is target `target` of `model`, p_A that of `arm`, and X_AM takes the frame of the
// model to that of the arm. Preconditions: both have the target; limits for every joint; count
// >= 1.
[[nodiscard]] double rms_tool_error(const Signature& model, const Signature& arm, int target,
                                    const Pose& X_AM,
                                    const FixedVector<JointLimits, kMaxJoints>& limits, int count);

// The drawing as a model of `arm`: laid over the arm's axes as well as it goes, with the arm's
// targets where they are at the arm's signature configuration. What a calibration of base and tool
// alone would give, or nearly so.
[[nodiscard]] Signature drawing_as_model(const Arm& drawing, const Signature& arm);

}  // namespace armsig::evaluation
