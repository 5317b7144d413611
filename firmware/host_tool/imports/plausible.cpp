// SPDX-License-Identifier: MIT
#include "firmware/host_tool/imports/plausible.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::tool {

bool are_radians(std::span<const double> angles_deg) {
  constexpr double kRounded = 1e-3;  // 1.57 is the coarsest that is written
  bool any = false;
  for (const double angle : angles_deg) {
    if (angle == 0) continue;
    const double quarters = std::round(angle / (kPi / 4));
    if (quarters == 0 || std::abs(angle - quarters * (kPi / 4)) > kRounded) return false;
    any = true;
  }
  return any;
}

}  // namespace armsig::tool
