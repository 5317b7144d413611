// SPDX-License-Identifier: MIT
#include "firmware/self_calibration/pose_choice.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/controller/pose_visit.hpp"
#include "firmware/controller/workspace.hpp"

namespace armsig::controller {
namespace {

// Numbers of spread_pose(): the first are those of the held-out poses and of the check.
constexpr std::size_t kFirstOffered = 64;
constexpr std::size_t kFirstSample = 1'000'000;
// Further than any play.
constexpr double kApproachAngle = radians(1.0);
constexpr double kApproachLength = 2e-3;

}  // namespace

JointVector offered_pose(const Configuration& configuration, std::size_t number) {
  return spread_pose(configuration, kFirstOffered + number);
}

JointVector sample_pose(const Configuration& configuration, std::size_t number) {
  return spread_pose(configuration, kFirstSample + number);
}

// Bits of a product with the golden ratio: no pattern of the poses' own.
Sides dealt_sides(std::size_t number) {
  auto mixed = static_cast<std::uint32_t>(number + 1) * 0x9E3779B9U;
  mixed ^= mixed >> 15U;
  mixed *= 0x85EBCA6BU;
  return static_cast<Sides>(mixed >> 24U);
}

JointVector approach(const Configuration& configuration) {
  JointVector ways;
  for (const DhJoint& row : configuration.drawing.joints) {
    ways.push_back(row.type == JointType::kRevolute ? kApproachAngle : kApproachLength);
  }
  return ways;
}

JointVector approach_to(const Configuration& configuration, const JointVector& pose, Sides& sides) {
  JointVector from = pose;
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const bool turns = configuration.drawing.joints[i].type == JointType::kRevolute;
    const double way = turns ? kApproachAngle : kApproachLength;
    const auto [lower, upper] = configuration.drawing.limits[i];
    const bool fits_below = pose[i] - way >= lower;
    const bool fits_above = pose[i] + way <= upper;
    const bool grows =
        side_of(sides, i) > 0 ? fits_below || !fits_above : fits_below && !fits_above;
    if (grows != (side_of(sides, i) > 0)) sides = static_cast<Sides>(sides ^ 1U << i);
    if (fits_below || fits_above) from[i] += grows ? -way : way;
  }
  return from;
}

}  // namespace armsig::controller
