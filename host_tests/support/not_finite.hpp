// SPDX-License-Identifier: MIT
// What no reading may be.
#pragma once

#include <limits>

namespace armsig::test {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace armsig::test
