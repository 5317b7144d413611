// SPDX-License-Identifier: MIT
// Where an arm stands under its sensor, by its reach: a small arm near, a long one far, a rail with
// its middle below the receivers.
#pragma once

#include <span>

#include "core/base/pose.hpp"
#include "hal/simulated/arm.hpp"

namespace armsig::simulated {

// Frame 0 of `arm` in the frame S of `receivers_S`, turned and off centre as demo_base_pose() is.
// The last target of the arm stays 0.1 m at least on the side `facing_S` of all receivers (zero:
// below them) at readings drawn from all of the joint limits; the middle of where it gets to is
// across from the middle of the receivers, to half a metre. The z axis of S is against gravity;
// that of an arm that hangs from a ceiling is with it, as its sensor stands below.
// Distances are whole decimetres. Without receivers: demo_base_pose().
[[nodiscard]] Pose base_pose(const SimulatedArm& arm, std::span<const Vector3> receivers_S,
                             const Vector3& facing_S);

}  // namespace armsig::simulated
