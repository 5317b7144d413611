// SPDX-License-Identifier: MIT
// The play of each joint, from poses that are reached from both of its sides.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "core/calibration/half_play.hpp"

namespace armsig::controller {

// From which side each joint comes to a pose: bit i set, its reading grows.
using Sides = std::uint8_t;

[[nodiscard]] inline double side_of(Sides sides, std::size_t joint) {
  return (sides >> joint & 1U) != 0 ? 1 : -1;
}

// How far a target moves when each joint moves by one [m per rad or m].
using Motions = std::array<Vector3, kMaxJoints>;

using calibration::half_plays;
using calibration::HalfPlay;
using calibration::HalfPlays;

}  // namespace armsig::controller
