// SPDX-License-Identifier: MIT
// Which touches of a layout to make, and what they will buy: greedily those that lower the
// predicted tool error most, from the prior alone (A-optimal design; docs/model.md, section 13).
#pragma once

#include <vector>

#include "firmware/host_tool/places/place_layout.hpp"

namespace armsig::tool {

struct PlacePlan {
  std::vector<std::size_t> touches;    // of the layout's task, the most useful first
  std::vector<double> expected_rms_m;  // of the tool, after each of them
  // The first so many touches reach what was asked; 0: they don't.
  std::size_t enough = 0;
};

// As few touches as reach `accuracy_m`, and so many that every place is checked by several and a
// sigma is found from them; `most` at most. Over configurations within the limits of the arm.
[[nodiscard]] PlacePlan plan_touches(const PlaceLayout& layout, double sigma_m, double accuracy_m,
                                     std::size_t most);

}  // namespace armsig::tool
