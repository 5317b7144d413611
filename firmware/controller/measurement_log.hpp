// SPDX-License-Identifier: MIT
// Everything that a sequence has measured, of fixed capacity.
#pragma once

#include <cstdint>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::controller {

inline constexpr std::size_t kMostSweepPoints = 60;  // of one joint
inline constexpr std::size_t kMostHeldOut = 16;

struct LogEntry {
  std::uint8_t sweep = 0;  // joint from 1, 0: a held-out pose
  std::uint8_t pings = 0;
  JointVector readings;  // actual, at standstill
  Vector3 p_S = Vector3::Zero();
  double sigma_m = 0;  // RMS over the axes
};

using MeasurementLog = FixedVector<LogEntry, kMaxJoints * kMostSweepPoints + kMostHeldOut>;

}  // namespace armsig::controller
