// SPDX-License-Identifier: MIT
// Joint readings that are outside of the arm's limits: nothing was measured there.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "core/base/arm.hpp"

namespace armsig::tool {

struct BeyondLimits {
  std::size_t rows = 0;   // so many have a joint outside
  std::size_t worst = 0;  // the row that is farthest, from 0
  std::string words;      // of that row: "joint 2 reads 4200.0°, its limits are -170.0° to 170.0°"
  // By a turn and more of a revolute joint, by its stroke and more of a prismatic one: no arm gets
  // there, and the unit is likely to be another.
  bool out_of_question = false;
};

// A measured arm may pass its drawing's limits a little, which says nothing. Nothing where all rows
// are inside, or the drawing has no limits. Precondition: a reading a joint.
[[nodiscard]] std::optional<BeyondLimits> beyond_limits(const Arm& drawing,
                                                        std::span<const JointVector> rows);

}  // namespace armsig::tool
