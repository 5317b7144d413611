// SPDX-License-Identifier: MIT
#pragma once

namespace armsig::features {

// A target nearer than this to the axis of a revolute joint tells little about that axis, however
// far the joint turns.
inline constexpr double kNextToAxis_m = 0.02;

}  // namespace armsig::features
