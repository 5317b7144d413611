// SPDX-License-Identifier: MIT
// Half of each joint's play as the rows alone say, from poses that are reached from both sides.
#pragma once

#include <cmath>

#include "core/base/arm.hpp"
#include "core/calibration/play_block.hpp"

namespace armsig::calibration {

// Half of a joint's play, as the rows alone say, without what the fit expects of it beforehand.
struct HalfPlay {
  double value = 0;  // rad or m
  double sigma = 0;  // infinite: the poses do not tell

  [[nodiscard]] bool is_seen() const { return std::abs(value) > 2 * sigma; }
  // Square of what is there, as far as more than chance shows it.
  [[nodiscard]] double squared() const;
};
using HalfPlays = FixedVector<HalfPlay, kMaxJoints>;

// After a fit that found the play of so many joints.
[[nodiscard]] HalfPlays half_plays(const PlayBlock& found, std::size_t joints);

}  // namespace armsig::calibration
