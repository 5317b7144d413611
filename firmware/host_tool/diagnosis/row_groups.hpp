// SPDX-License-Identifier: MIT
// Rows that were measured together: a sweep, or a run of poses. Blunders are strewn over all of
// them; a group that misses as a whole is a mistake.
#pragma once

#include <string>
#include <vector>

#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

struct GroupMiss {
  double length_m = 0;  // that three fifths of the group's rows miss by, or more
  std::string name;     // "sweep 2 (lines 22 to 41)"
};

// The group that misses most, of those with six rows or more. `lengths_m` has a row's residual at
// the row's index, or a negative number where it has none.
[[nodiscard]] GroupMiss worst_group(const Evidence& evidence, const std::vector<double>& lengths_m);

}  // namespace armsig::tool
