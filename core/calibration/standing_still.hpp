// SPDX-License-Identifier: MIT
// Which joints moved enough for rows to tell what depends on their own readings: a gear, a map, a
// coupling, backlash. Of one that stood still all of these are its zero.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include "core/base/arm.hpp"

namespace armsig::calibration {

// Between which readings of one joint rows are.
struct ReadingSpan {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();

  void add(double reading) {
    lower = std::min(lower, reading);
    upper = std::max(upper, reading);
  }
  // Nobody moves a joint by so little on purpose.
  [[nodiscard]] bool stood_still(JointType type) const {
    constexpr double kLeastTurn = radians(5);
    constexpr double kLeastShift_m = 0.02;
    return !(upper - lower >= (type == JointType::kRevolute ? kLeastTurn : kLeastShift_m));
  }
  // As little as a joint moves that its servo holds. Beyond it rows tell the joint's axis.
  [[nodiscard]] bool is_jitter(JointType type) const {
    constexpr double kMostTurn = radians(0.5);
    constexpr double kMostShift_m = 0.002;
    return !(upper - lower > (type == JointType::kRevolute ? kMostTurn : kMostShift_m));
  }
};

// Of one joint over rows, each of which says where its readings are.
template <typename Rows, typename Readings>
[[nodiscard]] bool stood_still(const Rows& rows, Readings readings, std::size_t joint,
                               JointType type) {
  ReadingSpan span;
  for (const auto& row : rows) span.add(readings(row)[joint]);
  return span.stood_still(type);
}

}  // namespace armsig::calibration
