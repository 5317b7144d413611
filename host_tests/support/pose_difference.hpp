// SPDX-License-Identifier: MIT
// How far two poses are from each other.
#pragma once

#include <algorithm>

#include "core/base/pose.hpp"

namespace armsig::test {

// The larger of position (m) and orientation (rad).
inline double pose_difference(const Pose& X, const Pose& Y) {
  return std::max((X.p - Y.p).norm(), angle_between(X.R, Y.R));
}

}  // namespace armsig::test
