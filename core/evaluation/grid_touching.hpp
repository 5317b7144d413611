// SPDX-License-Identifier: MIT
// The grid-touching task of section 4 of the paper: a workspace frame is taught by three points,
// the tool is sent to every vertex of a grid through the model under test, and the pose that the
// arm really takes is read.
#pragma once

#include "core/base/error.hpp"
#include "core/calibration/readings.hpp"
#include "core/evaluation/indices.hpp"
#include "core/kinematics/chain.hpp"

namespace armsig::evaluation {

// A model of an arm with a tool: pseudo-DH chain (21) and the tool point in the frame of its last
// link.
struct ToolModel {
  kinematics::Chain chain;
  Vector3 p_nT = Vector3::Zero();
};

// What the axes of a model turn by, told its effective readings: corrections, maps and gravity.
struct Turning {
  const calibration::ReadingModel* model = nullptr;  // null: by the readings alone; not kept
  JointVector configuration;  // effective readings at which the axes stand as the readings say
};

// The readings that the axes stand at, and back. Precondition: as many as joints.
[[nodiscard]] JointVector turned(const Turning& turning, const JointVector& effective);
[[nodiscard]] JointVector effective_for(const Turning& turning, const JointVector& axes);

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
// true poses in the workspace frame of the points it was taught; both turn by their readings as
// told. Readings are not quantised. Errors: kOutOfReach, kJointLimit, kNotConverged (a vertex that
// the model can't reach), kNotFinite.
[[nodiscard]] Result<GridReadings> touch_grid(const ToolModel& model, const ToolModel& truth,
                                              const GridPlacement& placement,
                                              const Turning& of_model = {},
                                              const Turning& of_truth = {});

}  // namespace armsig::evaluation
