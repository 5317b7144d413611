// SPDX-License-Identifier: MIT
// Joint readings that are outside of the arm's limits: nothing was measured there.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/base/arm.hpp"
#include "firmware/formats/problem.hpp"

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

// A reading that is no reading of its joint: beyond its limits by more than a turn of a revolute
// joint, or than the stroke of a prismatic one. Limits are not stops, and a controller may count a
// turn more than the drawing does; nothing explains more.
struct ImpossibleReading {
  std::size_t joint = 0;  // from 0
  std::string words;      // "joint 2 reads 4200.000°, its limits are -170.000° to 170.000°"
};

// That of `q` which is farthest out; nothing where the drawing has no limits.
[[nodiscard]] std::optional<ImpossibleReading> impossible_reading(const Arm& drawing,
                                                                  const JointVector& q);

// How many rows have one, and what is wrong then.
struct ImpossibleRows {
  std::size_t rows = 0;
  Problem first;  // of the first of them: where, and what

  void add(Problem problem);
  // Of so many rows altogether. In half of them and more it is not a row that is wrong, but the
  // unit or the order of the joints. `unit_from`: what says the unit.
  [[nodiscard]] Problem problem(std::size_t of, std::string_view unit_from) const;
};

}  // namespace armsig::tool
