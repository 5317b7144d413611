// SPDX-License-Identifier: MIT
// Numbers that no arm has in the unit that its file says: degrees under radians, millimetres under
// metres, and the reverse.
#pragma once

#include <span>

#include "core/base/pose.hpp"

namespace armsig::tool {

// Offsets and twists add up to a turn or two where joints were moved; 90 degrees are fourteen.
inline constexpr double kMostAngle_rad = 4 * kPi + 1e-6;
// No frame of an arm is farther from the one before it; a link of 60 mm taken for metres is.
inline constexpr double kMostLength_m = 50;
// A joint is stopped, or its cable is wound up, after so many turns; 360 degrees are fifty-seven.
inline constexpr double kMostTurns_rad = 8 * 2 * kPi;
// From here on a limit means that there is none: 1e16, the largest number, infinity.
inline constexpr double kNoLimit_rad = 1000 * 2 * kPi;
// A slide is shorter.
inline constexpr double kMostStroke_m = 100;
// All lengths of an arm together are more; a link of 425 mm taken for metres of it is 0.4 mm.
inline constexpr double kLeastArm_m = 0.01;

// Whether what is said to be degrees are radians: quarters and halves of a half turn, and zeros.
[[nodiscard]] bool are_radians(std::span<const double> angles_deg);

}  // namespace armsig::tool
