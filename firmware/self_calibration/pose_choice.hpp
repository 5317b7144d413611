// SPDX-License-Identifier: MIT
// Which poses the controller measures to calibrate itself: evenly spread, and of every few of them
// the one at which the model is known least. Each is reached from sides that its number deals.
#pragma once

#include "firmware/controller/configuration.hpp"
#include "firmware/controller/refinement.hpp"
#include "firmware/self_calibration/play.hpp"

namespace armsig::controller {

// Pose `number` of those that may be visited. None is one of the held-out poses of the
// identification, nor of sample_pose().
[[nodiscard]] JointVector offered_pose(const Configuration& configuration, std::size_t number);

// Pose `number` of those over which the accuracy is predicted; as spread, and never measured.
[[nodiscard]] JointVector sample_pose(const Configuration& configuration, std::size_t number);

// From which sides pose `number` is reached.
[[nodiscard]] Sides dealt_sides(std::size_t number);

// How far each joint is from its reading at the pose, at most, where it comes to it from.
[[nodiscard]] JointVector approach(const Configuration& configuration);

// Where a joint starts from that comes to `pose` from these sides: some way before it, inside of
// its limits. A side on which there is no room is changed in `sides`.
[[nodiscard]] JointVector approach_to(const Configuration& configuration, const JointVector& pose,
                                      Sides& sides);

}  // namespace armsig::controller
