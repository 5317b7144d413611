// SPDX-License-Identifier: MIT
// The grid-touching task of section 4 of the paper: a workspace frame is taught by three points,
// the tool is sent to every vertex of a grid through the model under test, and the pose that the
// arm really takes is read.
#pragma once

#include "core/base/error.hpp"
#include "core/evaluation/indices.hpp"
#include "core/kinematics/chain.hpp"

namespace armsig::evaluation {

// A model of an arm with a tool: pseudo-DH chain (21) and the tool point in the frame of its last
// link.
struct ToolModel {
  kinematics::Chain chain;
  Vector3 p_nT = Vector3::Zero();
};

// Joint readings of the arm at the three taught points (origin, on the x axis, in the xy plane).
using TaughtReadings = std::array<JointVector, 3>;

struct GridPlacement {
  TaughtReadings taught;
  Grid grid;  // the grid asked for, or one shrunk in proportion until it fits the arm
};

// Finds a place for the grid where the arm `drawing` reaches every vertex with one orientation of
// the tool, within its joint limits and as far from singular configurations as the candidates
// allow. Deterministic. Errors: kOutOfReach (no place even for a tenth of the grid).
[[nodiscard]] Result<GridPlacement> place_grid(const ToolModel& drawing, const Grid& grid);

// Sends the arm `truth` to every vertex by way of the inverse kinematics of `model`, and reads its
// true poses in the workspace frame of the points it was taught. Readings are not quantised.
// Errors: kOutOfReach, kJointLimit, kNotConverged (a vertex that the model can't reach),
// kNotFinite.
[[nodiscard]] Result<GridReadings> touch_grid(const ToolModel& model, const ToolModel& truth,
                                              const GridPlacement& placement);

}  // namespace armsig::evaluation
