// SPDX-License-Identifier: MIT
// Fixed-axis angles, as URDF and LinuxCNC (A, B, C) have them.
#pragma once

#include "core/base/pose.hpp"

namespace armsig {

// R = Rot(z, yaw) Rot(y, pitch) Rot(x, roll); exact to rounding near pitch = +-90 degrees too,
// where only roll - yaw or roll + yaw is determined.
struct RollPitchYaw {
  double roll_rad = 0;
  double pitch_rad = 0;
  double yaw_rad = 0;
};

[[nodiscard]] inline RollPitchYaw roll_pitch_yaw(const Matrix3& R) {
  const double across = std::hypot(R(0, 0), R(1, 0));
  const double yaw = across > 0 ? std::atan2(R(1, 0), R(0, 0)) : 0;
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  // Roll from what is left when this very yaw is taken away: an ill-determined yaw costs nothing.
  const double roll = std::atan2(s * R(0, 2) - c * R(1, 2), c * R(1, 1) - s * R(0, 1));
  return {roll, std::atan2(-R(2, 0), across), yaw};
}

[[nodiscard]] inline Matrix3 rotation_of(const RollPitchYaw& angles) {
  const double c = std::cos(angles.pitch_rad);
  const double s = std::sin(angles.pitch_rad);
  return rotation_z(angles.yaw_rad) * Matrix3{{c, 0, s}, {0, 1, 0}, {-s, 0, c}} *
         rotation_x(angles.roll_rad);
}

}  // namespace armsig
