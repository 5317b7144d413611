// SPDX-License-Identifier: MIT
// Which touches of a layout to make, and what they will buy: greedily those that lower the
// predicted tool error most, from the prior alone (A-optimal design; docs/model.md, section 13).
#pragma once

#include <vector>

#include "firmware/host_tool/places/place_layout.hpp"

namespace armsig::tool {

struct PlacePlan {
  std::vector<std::size_t> touches;    // of the layout's task, the most useful first; one at least
  std::vector<double> expected_rms_m;  // of the tool, after each of them
  // What was asked is reached, and every place is touched often enough to be checked.
  bool is_whole = false;
};

// As few touches as reach `accuracy_m`, and so many that every place is checked by several and a
// sigma is found from them; `most` at most. Precondition: the layout has a touch; most >= 1.
[[nodiscard]] PlacePlan plan_touches(const PlaceLayout& layout, double sigma_m, double accuracy_m,
                                     std::size_t most);

}  // namespace armsig::tool
