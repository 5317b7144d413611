// SPDX-License-Identifier: MIT
// What the kinematics module of LinuxCNC knows of an arm: what `armsig export --format
// linuxcnc-kins` writes and it reads when it is loaded. Lengths in metres, angles in radians.
#pragma once

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "core/calibration/packed_deflections.hpp"
#include "core/signature.hpp"

namespace armsig::linuxcnc {

// A target on the last link.
struct ToolPoint {
  int number = 0;
  Vector3 p_nT = Vector3::Zero();
};

struct KinsModel {
  Arm arm;    // the signature's rows; limits and couplings of the drawing
  Pose X_nL;  // the last link's frame, which `armsig predict` answers for, in frame n of the rows
  FixedVector<ToolPoint, kMaxTargets> tools;
  // Gravity and maps, if there are any: what they are by, and where they are zero.
  calibration::PackedDeflections deflections;
  DhRows drawn;               // rows of the drawing
  JointVector configuration;  // effective readings
};

}  // namespace armsig::linuxcnc
