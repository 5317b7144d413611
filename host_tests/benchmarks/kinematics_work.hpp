// SPDX-License-Identifier: MIT
// The work of the kinematics rows: a Puma 560 as built, poses away from its singularities, seeds
// half a degree away in every joint.
#pragma once

#include <array>
#include <cstddef>

#include "core/kinematics/forward.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::benchmarks {

inline constexpr std::size_t kPoses = 256;  // a power of two

struct KinematicsWork {
  test::KnownArm arm;
  kinematics::Chain chain;
  std::array<JointVector, kPoses> q;
  std::array<JointVector, kPoses> seed;
  std::array<Pose, kPoses> X_0n;
};

const KinematicsWork& kinematics_work();

}  // namespace armsig::benchmarks
