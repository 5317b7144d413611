// SPDX-License-Identifier: MIT
#include "firmware/host_tool/reading/beyond_limits.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "core/base/pose.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

constexpr double kALittle = 0.01;  // of the range that the limits leave

// How far outside, in units of what nobody gets beyond.
double beyond(JointType type, const JointLimits& limits, double reading) {
  const double outside = std::max(limits.lower - reading, reading - limits.upper);
  const double range = limits.upper - limits.lower;
  if (outside <= kALittle * range) return 0;
  return outside / (type == JointType::kRevolute ? 2 * kPi : range);
}

}  // namespace

std::optional<BeyondLimits> beyond_limits(const Arm& drawing, std::span<const JointVector> rows) {
  if (drawing.limits.size() != drawing.joints.size()) return std::nullopt;
  BeyondLimits found;
  double farthest = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    bool outside = false;
    for (std::size_t j = 0; j < rows[k].size(); ++j) {
      const JointType type = drawing.joints[j].type;
      const JointLimits& limits = drawing.limits[j];
      const double by = beyond(type, limits, rows[k][j]);
      outside = outside || by > 0;
      if (by <= farthest) continue;
      farthest = by;
      found.worst = k;
      found.words = fmt::format(
          "joint {} reads {}, its limits are {} to {}", j + 1, reading_in_words(type, rows[k][j]),
          reading_in_words(type, limits.lower), reading_in_words(type, limits.upper));
    }
    found.rows += outside ? 1 : 0;
  }
  if (found.rows == 0) return std::nullopt;
  found.out_of_question = farthest > 1;
  return found;
}

}  // namespace armsig::tool
