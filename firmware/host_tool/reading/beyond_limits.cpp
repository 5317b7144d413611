// SPDX-License-Identifier: MIT
#include "firmware/host_tool/reading/beyond_limits.hpp"

#include <algorithm>
#include <utility>

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

std::string beyond_in_words(std::size_t joint, JointType type, const JointLimits& limits,
                            double reading) {
  return fmt::format("joint {} reads {}, its limits are {} to {}", joint + 1,
                     reading_in_words(type, reading), reading_in_words(type, limits.lower),
                     reading_in_words(type, limits.upper));
}

}  // namespace

std::optional<ImpossibleReading> impossible_reading(const Arm& drawing, const JointVector& q) {
  if (drawing.limits.size() != q.size()) return std::nullopt;
  std::optional<ImpossibleReading> found;
  double farthest = 1;
  for (std::size_t j = 0; j < q.size(); ++j) {
    const JointType type = drawing.joints[j].type;
    const double by = beyond(type, drawing.limits[j], q[j]);
    if (by <= farthest) continue;
    farthest = by;
    found =
        ImpossibleReading{.joint = j, .words = beyond_in_words(j, type, drawing.limits[j], q[j])};
  }
  return found;
}

void ImpossibleRows::add(Problem problem) {
  if (rows++ == 0) first = std::move(problem);
}

Problem ImpossibleRows::problem(std::size_t of, std::string_view unit_from) const {
  Problem problem = first;
  if (2 * rows >= of) {
    problem.what += fmt::format(
        "; {} of {} rows are so: the unit (degrees or radians) or the order of the joints is wrong",
        rows, of);
    problem.expected = fmt::format(
        "readings in the unit that {} says, of the joints in the order of the arm description",
        unit_from);
    return problem;
  }
  if (rows > 1) problem.what += fmt::format("; {} of {} rows are so", rows, of);
  problem.expected = fmt::format(
      "readings in the unit that {} says; whole turns taken off a joint that turns without an end",
      unit_from);
  return problem;
}

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
      found.words = beyond_in_words(j, type, limits, rows[k][j]);
    }
    found.rows += outside ? 1 : 0;
  }
  if (found.rows == 0) return std::nullopt;
  found.out_of_question = farthest > 1;
  return found;
}

}  // namespace armsig::tool
