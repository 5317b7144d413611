// SPDX-License-Identifier: MIT
// An exact arm: where its links and the targets on them really are.
#pragma once

#include <cstddef>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::simulated {

inline constexpr std::size_t kMaxTargets = 32;

// A target point, fixed to link `link` (1 = the link that joint 1 moves, n = the last) at p_L
// metres in that link's Denavit-Hartenberg frame.
struct Target {
  int number = 0;
  std::size_t link = 0;
  Vector3 p_L = Vector3::Zero();
};

struct SimulatedArm {
  Arm arm;    // as it was built, not as it was drawn
  Pose X_S0;  // frame 0 of the arm in the sensor frame S
  FixedVector<Target, kMaxTargets> targets;
};

// The same arm with all its lengths, those of its links and offsets, longer by `share` of
// themselves: as it is when it has warmed up.
[[nodiscard]] SimulatedArm grown(const SimulatedArm& arm, double share);

// X_SL of link `link` (0 ... n) at the joint readings: X_S0 times the product of (2) of the paper
// over the joints up to `link`.
[[nodiscard]] Pose link_pose(const SimulatedArm& arm, const JointVector& readings,
                             std::size_t link);

// X_SL of every link, 0 ... n.
[[nodiscard]] FixedVector<Pose, kMaxFrames> link_poses(const SimulatedArm& arm,
                                                       const JointVector& readings);

// p_S of a target at the joint readings.
[[nodiscard]] Vector3 target_position(const SimulatedArm& arm, const JointVector& readings,
                                      const Target& target);

}  // namespace armsig::simulated
