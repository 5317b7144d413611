// SPDX-License-Identifier: MIT
// Known answers for the self-tests on a target: poses of the arms of the shared data (without it,
// of the paper's arms alone), and exact sweeps of robot 1 of Table 2. make_known_answers computes
// them when the image is built, apart from the code under test.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/base/arm.hpp"

namespace armsig::selftest {

inline constexpr std::size_t kPoses = 8;
inline constexpr std::size_t kPoints = 12;
inline constexpr std::size_t kSweptJoints = 6;

// Frame n in frame 0: position, and rotation row by row.
struct KnownPose {
  std::array<double, kMaxJoints> q;
  std::array<double, 3> p_m;
  std::array<double, 9> R;
};

struct KnownArm {
  const char* name;
  std::size_t joint_count;
  std::array<DhJoint, kMaxJoints> rows;
  std::array<KnownPose, kPoses> poses;
};

// Target positions in the sensor frame, metres.
struct SweptPoint {
  double reading;
  std::array<double, 3> p_S;
};
struct HeldOutPose {
  std::array<double, kSweptJoints> q;
  std::array<double, 3> p_S;
};

struct SweptArm {
  std::array<DhJoint, kSweptJoints> drawing;
  std::array<double, kSweptJoints> configuration;  // the signature configuration
  std::array<double, 3> target_S;                  // the target in it
  std::array<std::array<SweptPoint, kPoints>, kSweptJoints> sweeps;
  std::array<HeldOutPose, kPoses> held_out;
};

extern const std::span<const KnownArm> kArms;
extern const char* const kOriginOfArms;
extern const SweptArm kSwept;

}  // namespace armsig::selftest
