// SPDX-License-Identifier: MIT
#include "core/frames/sense.hpp"

#include <bit>
#include <cmath>

namespace armsig::frames {
namespace {

// A refusal must be sure: reversed or mirrored axes have to match twice as well as drawn ones.
// Wrong zeros can look like reversed joints, but seldom as closely as that.
constexpr double kRefusalShare = 0.5;

using JointSet = unsigned;  // bit i: joint i

bool contains(JointSet set, std::size_t joint) { return ((set >> joint) & 1U) != 0; }

double angle(const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// `share` of the bounds of a match.
bool is_match(const Alignment& alignment, const AxisLines& drawn, double share) {
  return alignment.worst_angle_rad() <= share * kMatchAngleRad &&
         alignment.worst_distance_m() <= share * kMatchFraction * arm_size(drawn);
}

// False where no rotation can bring every direction within the bound: the angle between two axes is
// not changed by rotating them together. Saves most alignments.
bool may_match(const AxisLines& drawn, const AxisLines& found) {
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double drawn_rad = angle(drawn[i].direction, drawn[j].direction);
      const double found_rad = angle(found[i].direction, found[j].direction);
      if (std::abs(drawn_rad - found_rad) > 2 * kRefusalShare * kMatchAngleRad) return false;
    }
  }
  return true;
}

bool explains(const AxisLines& drawn, const AxisLines& found) {
  return may_match(drawn, found) && is_match(align(found, drawn), drawn, kRefusalShare);
}

bool matches_with_reversed(const Arm& nominal, const JointVector& configuration,
                           const AxisLines& identified, JointSet reversed) {
  AxisLines found = identified;
  JointVector negated = configuration;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!contains(reversed, i)) continue;
    found[i].direction = -found[i].direction;
    negated[i] = -negated[i];
  }
  return explains(axis_lines(nominal, negated), found) ||
         explains(axis_lines(nominal, configuration), found);
}

// Reflection of all positions through a point; any other reflection is this one and a rotation. The
// axis of a rotation is an axial vector and keeps its direction, a direction of travel does not.
AxisLines reflected(const AxisLines& lines) {
  AxisLines mirrored = lines;
  for (AxisLine& line : mirrored) {
    line.point = -line.point;
    if (line.type == JointType::kPrismatic) line.direction = -line.direction;
  }
  return mirrored;
}

}  // namespace

SenseCheck check_sense(const Arm& nominal, const JointVector& configuration,
                       const AxisLines& identified) {
  const std::size_t n = nominal.joints.size();
  ARMSIG_CHECK(configuration.size() == n && identified.size() == n);
  const AxisLines drawn = axis_lines(nominal, configuration);
  const Alignment as_drawn = align(identified, drawn);

  SenseCheck check;
  check.reversed.resize(n, false);
  check.angle_rad = as_drawn.worst_angle_rad();
  check.distance_m = as_drawn.worst_distance_m();
  if (is_match(as_drawn, drawn, 1.0)) return check;

  const JointSet all = (1U << n) - 1U;
  for (int count = 1; count <= static_cast<int>(n); ++count) {
    for (JointSet reversed = 1; reversed <= all; ++reversed) {
      if (std::popcount(reversed) != count) continue;
      if (!matches_with_reversed(nominal, configuration, identified, reversed)) continue;
      check.verdict = SenseVerdict::kJointsReversed;
      for (std::size_t i = 0; i < n; ++i) check.reversed[i] = contains(reversed, i);
      return check;
    }
    if (count == 1 && explains(drawn, reflected(identified))) {
      check.verdict = SenseVerdict::kSensorMirrored;
      return check;
    }
  }
  check.verdict = SenseVerdict::kNoMatch;
  return check;
}

}  // namespace armsig::frames
