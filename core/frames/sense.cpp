// SPDX-License-Identifier: MIT
#include "core/frames/sense.hpp"

#include <bit>
#include <cmath>

#include "core/numerics/rotations.hpp"

namespace armsig::frames {
namespace {

// A refusal must be sure: reversed or mirrored axes have to match twice as well as drawn ones.
// Wrong zeros can look like reversed joints, but seldom as closely as that.
constexpr double kRefusalShare = 0.5;

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
      const double drawn_rad = numerics::angle_between(drawn[i].direction, drawn[j].direction);
      const double found_rad = numerics::angle_between(found[i].direction, found[j].direction);
      if (std::abs(drawn_rad - found_rad) > 2 * kRefusalShare * kMatchAngleRad) return false;
    }
  }
  return true;
}

AxisLines with_reversed(const AxisLines& lines, Subset reversed) {
  AxisLines turned = lines;
  for (std::size_t i = 0; i < turned.size(); ++i) {
    if (contains(reversed, i)) turned[i].direction = -turned[i].direction;
  }
  return turned;
}

JointVector with_negated(const JointVector& readings, Subset reversed) {
  JointVector negated = readings;
  for (std::size_t i = 0; i < negated.size(); ++i) {
    if (contains(reversed, i)) negated[i] = -negated[i];
  }
  return negated;
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

SenseChecking::SenseChecking(const Arm& drawing, const JointVector& configuration,
                             const AxisLines& identified)
    : drawing_(drawing), configuration_(configuration), identified_(identified) {
  const std::size_t n = drawing.joints.size();
  ARMSIG_CHECK(configuration.size() == n && identified.size() == n);
  check_.reversed.resize(n, false);
  drawn_ = axis_lines(drawing, configuration);
  aligning_.emplace(identified_, drawn_);
}

bool SenseChecking::step() {
  if (aligning_) {
    if (aligning_->step()) return true;
    if (judge()) return false;
    aligning_.reset();
  }
  if (advance()) {
    begin();
    return true;
  }
  check_.verdict = SenseVerdict::kNoMatch;
  return false;
}

// Fewest joints first; a mirrored sensor is as likely as one reversed joint.
bool SenseChecking::advance() {
  const std::size_t n = identified_.size();
  switch (explanation_) {
    case Explanation::kAsDrawn:
      reversed_ = 1;
      break;
    case Explanation::kNegated:
      explanation_ = Explanation::kReversed;
      return true;
    case Explanation::kReversed: {
      const int count = std::popcount(reversed_);
      reversed_ = next_of_as_many(reversed_);
      if (reversed_ < 1U << n) break;
      reversed_ = (1U << (count + 1)) - 1U;
      if (count == 1) {
        explanation_ = Explanation::kMirrored;
        return true;
      }
      break;
    }
    case Explanation::kMirrored:
      break;
  }
  explanation_ = Explanation::kNegated;
  return reversed_ < 1U << n;
}

void SenseChecking::begin() {
  const bool mirrored = explanation_ == Explanation::kMirrored;
  const bool negated = explanation_ == Explanation::kNegated;
  const AxisLines found = mirrored ? reflected(identified_) : with_reversed(identified_, reversed_);
  drawn_ = axis_lines(drawing_, negated ? with_negated(configuration_, reversed_) : configuration_);
  if (may_match(drawn_, found)) aligning_.emplace(found, drawn_);
}

bool SenseChecking::judge() {
  const Alignment alignment = aligning_->result();
  if (explanation_ == Explanation::kAsDrawn) {
    check_.angle_rad = alignment.worst_angle_rad();
    check_.distance_m = alignment.worst_distance_m();
    return is_match(alignment, drawn_, 1.0);
  }
  if (!is_match(alignment, drawn_, kRefusalShare)) return false;
  if (explanation_ == Explanation::kMirrored) {
    check_.verdict = SenseVerdict::kSensorMirrored;
    return true;
  }
  check_.verdict = SenseVerdict::kJointsReversed;
  for (std::size_t i = 0; i < identified_.size(); ++i) {
    check_.reversed[i] = contains(reversed_, i);
  }
  return true;
}

}  // namespace armsig::frames
