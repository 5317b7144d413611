// SPDX-License-Identifier: MIT
// The play of each joint, from poses that are reached from both of its sides.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "firmware/calibration/play_block.hpp"

namespace armsig::controller {

// From which side each joint comes to a pose: bit i set, its reading grows.
using Sides = std::uint8_t;

[[nodiscard]] inline double side_of(Sides sides, std::size_t joint) {
  return (sides >> joint & 1U) != 0 ? 1 : -1;
}

// How far a target moves when each joint moves by one [m per rad or m].
using Motions = std::array<Vector3, kMaxJoints>;

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
[[nodiscard]] HalfPlays half_plays(const calibration::PlayBlock& found, std::size_t joints);

}  // namespace armsig::controller
